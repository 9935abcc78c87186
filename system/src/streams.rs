//! Stdin and stdout of a worker for its messages alone: the library that it loads finds an empty stdin, and what it prints goes
//! to stderr. It may close all of them.

use std::fs::File;
use std::io;

/// Stdin for the requests.
#[cfg(unix)]
pub fn take_stdin() -> io::Result<File> {
    let requests = rustix::io::dup(io::stdin())?;
    rustix::stdio::dup2_stdin(File::open("/dev/null")?)?;
    Ok(requests.into())
}

/// Stdout for the replies.
#[cfg(unix)]
pub fn take_stdout() -> io::Result<File> {
    let replies = rustix::io::dup(io::stdout())?;
    rustix::stdio::dup2_stdout(io::stderr())?;
    Ok(replies.into())
}

/// Stdin for the requests.
#[cfg(windows)]
pub fn take_stdin() -> io::Result<File> {
    use std::os::windows::io::{AsHandle as _, IntoRawHandle as _};
    use windows_sys::Win32::System::Console::STD_INPUT_HANDLE;

    let requests = io::stdin().as_handle().try_clone_to_owned()?;
    tables::set(STD_INPUT_HANDLE, 0, File::open("NUL")?.into_raw_handle())?;
    Ok(requests.into())
}

/// Stdout for the replies.
#[cfg(windows)]
pub fn take_stdout() -> io::Result<File> {
    use std::os::windows::io::{AsHandle as _, IntoRawHandle as _};
    use windows_sys::Win32::System::Console::STD_OUTPUT_HANDLE;

    let replies = io::stdout().as_handle().try_clone_to_owned()?;
    let stderr = io::stderr().as_handle().try_clone_to_owned()?;
    tables::set(STD_OUTPUT_HANDLE, 1, stderr.into_raw_handle())?;
    Ok(replies.into())
}

/// Windows has the standard handles of the process, and each C library a table of its own, made from them when it is loaded.
#[cfg(windows)]
mod tables {
    use std::io;
    use std::os::windows::io::RawHandle;

    use windows_sys::Win32::System::Console::{STD_HANDLE, SetStdHandle};

    /// Puts `handle`, which from then on is theirs, in the place of a standard handle of the process and of descriptor `fd` of
    /// the C library of this program.
    pub fn set(standard: STD_HANDLE, fd: libc::c_int, handle: RawHandle) -> io::Result<()> {
        // SAFETY: the handle is open, and nobody else closes it: from here on it belongs to the descriptor.
        let from = unsafe { libc::open_osfhandle(handle as libc::intptr_t, libc::O_RDWR | libc::O_BINARY) };
        if from < 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: two numbers of descriptors, the first of which is open.
        if unsafe { libc::dup2(from, fd) } < 0 {
            return Err(io::Error::last_os_error());
        }
        // Last, since `dup2` sets it as well, to a copy that goes when the library closes the descriptor.
        // SAFETY: the handle stays open, as nobody closes `from`.
        if unsafe { SetStdHandle(standard, handle) } == 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
    }
}
