//! The command lines that are shipped for other batch systems can be used as they are.

use batch_runner::BatchSettings;

/// A study file, as far as it matters here.
#[derive(serde::Deserialize)]
struct File {
    /// The table.
    runner: BatchSettings,
}

#[test]
fn shipped_command_lines_are_accepted() {
    for text in [
        include_str!("../command-lines/lsf.toml"),
        include_str!("../command-lines/pbs.toml"),
        include_str!("../command-lines/sge.toml"),
        include_str!("../command-lines/ssh.toml"),
    ] {
        let file: File = toml::from_str(text).unwrap();
        file.runner.check().unwrap();
        let lines = file.runner.command.unwrap();
        for line in [lines.status, lines.cancel].into_iter().flatten() {
            assert!(!line.contains("{job}"), "{line}");
        }
        // Placeholders for which a file gives no value would be refused at the submission.
        let needs_time = lines.submit.contains("{time_limit}");
        assert!(!needs_time || file.runner.time_limit_s.is_some());
    }
}

/// What LSF prints becomes the number of the job.
#[test]
fn the_id_of_lsf_is_cut_out_of_its_words() {
    let text = include_str!("../command-lines/lsf.toml");
    let file: File = toml::from_str(text).unwrap();
    let line = file.runner.command.unwrap().submit;
    let (_, filter) = line.split_once("| ").unwrap();
    let line = format!("echo 'Job <123> is submitted to default queue <normal>.' | {filter}");
    let output = std::process::Command::new("sh")
        .args(["-c", &line])
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "123");
}
