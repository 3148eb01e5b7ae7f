//! The rows as Markdown tables.

use crate::measure::Row;

/// Table of this solver.
pub(crate) fn of_scenes(rows: &[Row]) -> String {
    let head = "| scene | seeds | spheres | contacts | time step (us) | us per step | \
        million sphere-steps/s | CPU-s per simulated second | peak memory (MiB) |\n\
        |---|---|---|---|---|---|---|---|---|";
    lines(head, rows, |row| {
        // A plain sphere is not a seed.
        let seeds = if row.seeds == row.spheres {
            "-".into()
        } else {
            row.seeds.to_string()
        };
        let contacts = row.contacts.map_or("-".into(), |n| n.to_string());
        format!(
            "| {} | {seeds} | {} | {contacts} | {:.1} | {} |",
            row.scene,
            row.spheres,
            row.time_step_s * 1e6,
            costs(row)
        )
    })
}

/// Table of the phases of a step, below that of this solver; empty if none were counted.
pub(crate) fn of_phases(rows: &[Row]) -> String {
    if rows.iter().all(|row| row.phases.is_none()) {
        return String::new();
    }
    let head = "| scene | search (us) | contacts (us) | walls of triangles, liquid (us) | motion (us) | read (bytes a body) |\n\
        |---|---|---|---|---|---|";
    let table = lines(head, rows, |row| {
        let Some(p) = row.phases else {
            return format!("| {} | - | - | - | - | - |", row.scene);
        };
        let read = row
            .bytes_of_step
            .map_or("-".into(), |n| (n / row.seeds).to_string());
        format!(
            "| {} | {:.2} | {:.2} | {:.2} | {:.2} | {read} |",
            row.scene, p.search_us, p.contacts_us, p.triangles_us, p.motion_us
        )
    });
    format!("\n\n{table}")
}

/// Table of all codes; times are by the clock where each has several processes or threads.
pub(crate) fn of_peers(rows: &[Row], by_clock: bool) -> String {
    let seconds = if by_clock { "s" } else { "CPU-s" };
    let head = "| scene | code | time step (us) | us per step | million sphere-steps/s | # per simulated \
        second | peak memory (MiB) | cost over seedloop | centre of mass (deg) | kinetic energy \
        (uJ) |\n|---|---|---|---|---|---|---|---|---|---|";
    lines(&head.replace('#', seconds), rows, |row| {
        let ratio = row
            .cost_over_seedloop
            .map_or("-".into(), |r| format!("{r:.2}"));
        format!(
            "| {} | {} | {:.1} | {} | {ratio} | {:.3} | {:.4} |",
            row.scene,
            row.code,
            row.time_step_s * 1e6,
            costs(row),
            row.centre_of_mass_deg,
            row.kinetic_energy_uj
        )
    })
}

fn lines(head: &str, rows: &[Row], line: impl Fn(&Row) -> String) -> String {
    let lines = rows.iter().map(line);
    std::iter::once(head.to_owned())
        .chain(lines)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Cells that both tables share.
fn costs(row: &Row) -> String {
    let memory = row.peak_memory_mib;
    let memory = memory.map_or("-".into(), |mib| format!("{mib:.0}"));
    format!(
        "{:.1} | {:.2} | {:.2} | {memory}",
        row.us_per_step,
        row.sphere_steps_per_s * 1e-6,
        row.cpu_s_per_simulated_s
    )
}
