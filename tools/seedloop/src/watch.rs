//! `seedloop watch FOLDER`: a campaign is shown while it runs.

use crate::stop::Stop;
use campaign_watch::{CampaignFolder, Server};
use command_line::{Common, DONE};
use serde::Serialize;
use std::path::PathBuf;

/// Shows a campaign while it runs, in a browser on this machine: stages, runs, charts, latest frames
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:\n  seedloop watch out/my-drum")]
pub(crate) struct Arguments {
    /// Result folder of calibrate, diagnose or run; nothing in it is changed
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,

    /// Port on 127.0.0.1 [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,

    #[command(flatten)]
    common: Common,
}

/// The address as it stands in JSON.
#[derive(Debug, Serialize)]
struct Report {
    /// Address of the page.
    address: String,
}

/// Prints the address and serves the page until Ctrl-C or SIGTERM.
///
/// # Errors
/// A folder that is no campaign, a port that is taken.
pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<u8> {
    let common = &arguments.common;
    common.try_outputs([])?;
    let folder = CampaignFolder::open(&arguments.folder)?;
    let told = format!("{} is as it was", folder.path().display());
    let stop = Stop::new(move || told.clone())?;
    let server = Server::bind(folder, arguments.port)?;
    let address = server.address();
    common.print(&address)?;
    common.emit_json(&Report { address })?;
    common.log(|| "open this address in a browser on this machine; Ctrl-C ends".to_owned());
    server.serve(stop.flag());
    let ended: Result<u8, anyhow::Error> = Err(anyhow::anyhow!("the server has ended"));
    Ok(match stop.result(ended)? {
        Ok(_) => DONE,
        Err(code) => code,
    })
}
