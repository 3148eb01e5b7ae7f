//! Arguments, exit codes and file writing that all commands share.
