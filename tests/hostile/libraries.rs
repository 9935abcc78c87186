//! Libraries of FMUs that fall, hang, swell, lie or close what is not theirs.

use super::sandbox::{Given, Input};

fn check(what: &'static str, macros: &[&str], options: &[&'static str]) -> Input {
    let macros = macros.iter().map(|it| (*it).to_owned()).collect();
    Input { what, given: Given::Library(macros, options.to_vec()), code: 2 }
}

const LIMIT: [&str; 2] = ["--time-limit", "3"];
const SMALL: [&str; 2] = ["--memory-limit", "1024"];

/// All of them.
pub fn inputs() -> Vec<Input> {
    let passed = |input: Input| Input { code: 0, ..input };
    let failed = |input: Input| Input { code: 1, ..input };
    let swell = "STEP=for (;;) memset(malloc(1 << 20), 1, 1 << 20);";
    let child = "STEP=if (!fork()) { setsid(); sleep(3); _exit(0); } _exit(3);";
    let garbage = "STEP=for (int i = 3; i < 64; ++i) write(i, \"garbage, garbage\", 16); pause();";
    vec![
        check("falls while it is loaded", &["LOADING=*(volatile int *)0 = 1;"], &[]),
        check("hangs while it is loaded", &["LOADING=for (;;);"], &LIMIT),
        check("ends the process while it is loaded", &["LOADING=exit(0);"], &[]),
        check("falls in fmi2Instantiate", &["INSTANTIATE=*(volatile int *)0 = 1;"], &[]),
        failed(check(
            "returns NULL from fmi2Instantiate",
            &["INSTANTIATE=LOG(3, \"%s\", \"not today\"); return NULL;"],
            &[],
        )),
        check(
            "falls in fmi2DoStep",
            &["STEP=if (time > 0.25) { LOG(3, \"%s\", \"too late\"); *(volatile int *)0 = 1; }"],
            &[],
        ),
        check("divides by zero", &["STEP=raise(SIGFPE);"], &[]),
        check("aborts", &["STEP=abort();"], &[]),
        check("ends the process with exit(0)", &["STEP=exit(0);"], &[]),
        check("hangs in fmi2DoStep", &["STEP=for (;;);"], &LIMIT),
        check("logs without end", &["STEP=for (;;) LOG(1, \"%s\", \"again\");"], &LIMIT),
        check("allocates without end", &[swell], &SMALL),
        check("overflows the stack", &["STEP=return fmi2DoStep(self, time, step + 1, forget) + (int)self->y;"], &[]),
        check("falls in fmi2FreeInstance", &["FREE=*(volatile int *)0 = 1;"], &[]),
        check("falls while it is unloaded", &["UNLOADING=abort();"], &[]),
        check("leaves a child that holds the pipes open", &[child], &[]),
        check("closes every pipe and goes on", &["STEP=for (int i = 0; i < 64; ++i) close(i); pause();"], &[]),
        check("writes garbage to every pipe", &[garbage], &[]),
        passed(check("prints to stdout", &["STEP=puts(\"noise\"); fflush(stdout);"], &[])),
        passed(check("closes stdin, stdout and stderr", &["STEP=close(0); close(1); close(2);"], &[])),
        passed(check("logs NULL", &["STEP=LOG(1, NULL); LOG(1, \"%s\", NULL);"], &[])),
        failed(check(
            "logs what commands the terminal, and fails",
            &["STEP=LOG(3, \"\\033[2J\\xff\"); return 3;"],
            &[],
        )),
        failed(check("returns the status 77", &["STEP=return 77;"], &[])),
        failed(check("reports a fatal error", &["STEP=return 4;"], &[])),
        passed(check("writes a file into its working folder", &["STEP=fclose(fopen(\"canary\", \"w\"));"], &[])),
    ]
}
