//! Parsing the command line, and what shells and `man` read about a command: `--generate`.

use clap::{Arg, Command, CommandFactory, FromArgMatches, ValueEnum};
use clap_complete::Shell;
use std::ffi::OsString;

/// Output of `--generate`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Completion for bash
    CompleteBash,
    /// Completion for zsh
    CompleteZsh,
    /// Completion for fish
    CompleteFish,
    /// Completion for `PowerShell`
    CompletePowershell,
    /// The man page, in roff
    Man,
}

/// Name of the flag.
const FLAG: &str = "generate";

/// Parses the words of the command line. `--generate KIND` as the first word writes a completion or the man page on
/// standard output and ends the command; help, version and wrong usage end it as clap does.
pub fn parse<C: CommandFactory + FromArgMatches>() -> C {
    let words = crate::words::arguments().collect();
    parse_words(words, &mut std::io::stdout()).unwrap_or_else(|error| error.exit())
}

/// Parses words. Help and version are errors, as in clap, and are written to `out`.
fn parse_words<C: CommandFactory + FromArgMatches>(
    words: Vec<OsString>,
    out: &mut dyn std::io::Write,
) -> Result<C, clap::Error> {
    let mut command = with_flag(C::command());
    if let Some(kind) = asked(&words)? {
        let mut text = Vec::new();
        let written = generate(kind, &mut command, &mut text).and_then(|()| out.write_all(&text));
        // A reader that has closed standard output has what it wanted.
        let refused = written
            .err()
            .filter(|error| error.kind() != std::io::ErrorKind::BrokenPipe);
        return Err(refused.map_or_else(
            || clap::Error::raw(clap::error::ErrorKind::DisplayHelp, ""),
            |error| {
                clap::Error::raw(
                    clap::error::ErrorKind::Io,
                    format!("cannot write to standard output: {error}\n"),
                )
            },
        ));
    }
    let mut matches = command.try_get_matches_from_mut(words)?;
    C::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command))
}

/// The command with the flag in its help.
fn with_flag(command: Command) -> Command {
    let flag = Arg::new(FLAG)
        .long(FLAG)
        .value_name("KIND")
        .value_parser(clap::builder::EnumValueParser::<Kind>::new())
        .hide_possible_values(true)
        .exclusive(true)
        .help(
            "Writes shell completion (complete-bash, complete-zsh, complete-fish, complete-powershell) or the man page (man) \
             on standard output",
        );
    command.arg(flag)
}

/// The kind that the first word requests; `None` if it is not the flag.
fn asked(words: &[OsString]) -> Result<Option<Kind>, clap::Error> {
    let first = words
        .get(1)
        .and_then(|word| word.to_str())
        .unwrap_or_default();
    if first != "--generate" && !first.starts_with("--generate=") {
        return Ok(None);
    }
    // Alone, the flag needs none of what a run needs.
    let alone = with_flag(Command::new("generate"));
    let matches = alone.try_get_matches_from(words)?;
    Ok(matches.get_one::<Kind>(FLAG).copied())
}

/// Writes a completion or the man page.
fn generate(kind: Kind, command: &mut Command, out: &mut Vec<u8>) -> std::io::Result<()> {
    let shell = match kind {
        Kind::CompleteBash => Shell::Bash,
        Kind::CompleteZsh => Shell::Zsh,
        Kind::CompleteFish => Shell::Fish,
        Kind::CompletePowershell => Shell::PowerShell,
        Kind::Man => return man(command, out),
    };
    let name = command.get_name().to_owned();
    clap_complete::generate(shell, command, name, out);
    Ok(())
}

/// One page with the command and all that it can do.
fn man(command: &mut Command, out: &mut Vec<u8>) -> std::io::Result<()> {
    use std::io::Write as _;
    command.build();
    let page = clap_mangen::Man::new(command.clone());
    let mut whole = Vec::new();
    page.render(&mut whole)?;
    // What stands behind the help is an example.
    out.extend(
        String::from_utf8_lossy(&whole)
            .replace(".SH EXTRA\n", ".SH EXAMPLES\n")
            .bytes(),
    );
    let shown = command
        .get_subcommands()
        .filter(|sub| !sub.is_hide_set() && sub.get_name() != "help");
    for sub in shown {
        writeln!(out, ".SH \"{}\"", sub.get_name().to_uppercase())?;
        let page = clap_mangen::Man::new(sub.clone());
        let mut part = Vec::new();
        page.render_description_section(&mut part)?;
        page.render_synopsis_section(&mut part)?;
        page.render_options_section(&mut part)?;
        page.render_extra_section(&mut part)?;
        // Sections of a subcommand stand below its own.
        let part = String::from_utf8_lossy(&part);
        out.extend(
            part.replace(".SH EXTRA\n", ".SH EXAMPLES\n")
                .replace(".SH ", ".SS ")
                .bytes(),
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Kind, generate, parse_words, with_flag};
    use clap::{CommandFactory as _, Parser, ValueEnum as _};
    use std::ffi::OsString;

    /// Measures what must be measured
    #[derive(Debug, Parser)]
    #[command(name = "measure", after_help = "Example:\n  measure photo.jpg")]
    struct Measure {
        /// Photo to be read
        #[arg(required = true)]
        photo: Vec<String>,
        /// Seed of all random numbers
        #[arg(long)]
        seed: Option<u64>,
    }

    fn words(line: &str) -> Vec<OsString> {
        line.split(' ').map(OsString::from).collect()
    }

    /// The flag needs no photo and must be alone: with a photo it is an error, and so is an unknown kind.
    #[test]
    fn the_flag_stands_alone() {
        let mut out = Vec::new();
        let plain: Measure = parse_words(words("measure a.jpg --seed 3"), &mut out).unwrap();
        assert_eq!((plain.photo.len(), plain.seed), (1, Some(3)));
        let mut code = |line: &str| {
            let answer = parse_words::<Measure>(words(line), &mut out);
            answer.unwrap_err().exit_code()
        };
        assert_eq!(code("measure --generate complete-bash"), 0);
        assert_eq!(code("measure --generate=man"), 0);
        for wrong in [
            "measure --generate",
            "measure --generate tcsh",
            "measure a.jpg --generate man",
            "measure --generate man a.jpg",
        ] {
            assert_eq!(code(wrong), 2, "{wrong}");
        }
    }

    /// Each kind names the command and its flags; the man page is roff and holds the example.
    #[test]
    fn every_kind_knows_the_flags_of_the_command() {
        for kind in Kind::value_variants() {
            let mut text = Vec::new();
            generate(*kind, &mut with_flag(Measure::command()), &mut text).unwrap();
            let text = String::from_utf8(text).unwrap();
            assert!(
                text.contains("measure") && text.contains("seed"),
                "{kind:?}"
            );
            if *kind == Kind::Man {
                assert!(
                    text.contains(".TH measure 1") && text.contains("measure photo.jpg"),
                    "{text}"
                );
            }
        }
    }
}
