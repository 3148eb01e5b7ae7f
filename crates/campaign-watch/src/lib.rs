//! A campaign watched while it runs: one page on the loopback address, read only.
//!
//! [`CampaignFolder`] looks at what a campaign writes, and [`Server`] shows it to whoever has the address, which holds a random
//! token.
//!
//! ```no_run
//! use campaign_watch::{CampaignFolder, Server};
//! use std::sync::atomic::AtomicBool;
//!
//! # fn main() -> Result<(), campaign_watch::Error> {
//! let folder = CampaignFolder::open("out/example".as_ref())?;
//! let server = Server::bind(folder, 0)?;
//! println!("{}", server.address());
//! server.serve(&AtomicBool::new(false));
//! # Ok(())
//! # }
//! ```
//!
//! Invariants:
//! - nothing in the folder is made, locked, changed or waited for, and what is damaged there costs its own place in the page only;
//! - a request names one of three things that are in memory: no part of it reaches the file system;
//! - a request without the token, or sent by the page of another, gets nothing of the campaign;
//! - a client that is slow, or sends too much, holds up nobody else.

#[cfg(test)]
mod browser;
mod charts;
mod error;
mod folder;
mod number;
mod page;
mod request;
mod server;
#[cfg(test)]
mod test_campaign;
#[cfg(test)]
mod tests;
mod view;

pub use error::Error;
pub use folder::CampaignFolder;
pub use server::Server;
