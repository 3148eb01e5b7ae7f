//! Campaigns and their records as a user of the crate meets them.

mod campaigns;
mod claims;
mod common;
mod damage;
mod faults;
mod further;
mod processes;
mod run_store_processes;
mod shared_folder;
mod store;
