//! Memory in pages of 2 MiB.

/// Starts the program again, in the same process, with a C library that asks Linux for pages of 2 MiB; does nothing where this
/// cannot be asked for, or where `GLIBC_TUNABLES` says already what the library shall do.
///
/// A step in a bed of seeds reads some 2 kB of each seed. In pages of 4 KiB their addresses alone take a tenth of its time
/// (docs/benchmarks.md). The library reads the variable before `main`, so the running process cannot set it for itself.
/// Programs that it starts inherit the variable.
pub fn use_huge_pages() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        use std::os::unix::process::CommandExt as _;
        let variable = "GLIBC_TUNABLES";
        let Ok(program) = std::env::current_exe() else {
            return;
        };
        if std::env::var_os(variable).is_some() {
            return;
        }
        let mut arguments = std::env::args_os();
        let mut again = std::process::Command::new(program);
        if let Some(name) = arguments.next() {
            again.arg0(name);
        }
        again
            .args(arguments)
            .env(variable, "glibc.malloc.hugetlb=1");
        // Comes back only if it fails; the program is the same without.
        let _error = again.exec();
    }
}
