//! Files of a run's folder, or a file of another command, written completely or not at all.
//!
//! *Temporary*: a hidden sibling (`.NAME.PID.part`) into which a file is written until the whole run is done. It is in the same
//! folder, so it can be renamed into place in one step.
//!
//! Dropping [`RunFiles`] without [`RunFiles::commit`] removes the temporaries, and the folders that were created for them,
//! unless another process has put something there. The files of an earlier run are unchanged until the commit. A process that
//! is ended by a signal leaves its temporaries, unless it catches the signal and calls [`RunFiles::take_all_away`].

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Component, Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use thiserror::Error;

/// Failed operation, and its path.
#[derive(Debug, Error)]
pub enum RunFilesError {
    /// The file system refused.
    #[error("cannot {operation} {}: {source}", path.display())]
    Io {
        /// Operation in words: `create the folder`, `create`, `put in place`.
        operation: &'static str,
        /// Path of the file or folder.
        path: PathBuf,
        /// Error of the file system.
        source: io::Error,
    },
    /// The name is not that of a file directly in the folder.
    #[error("`{0}` is not a plain file name")]
    Name(String),
    /// The name was requested before.
    #[error("`{0}` is already being written")]
    Twice(String),
}

/// Temporaries and folders of all runs that are not committed yet, innermost folders first.
static UNFINISHED: Mutex<Unfinished> = Mutex::new(Unfinished {
    files: Vec::new(),
    folders: Vec::new(),
});

#[derive(Debug)]
struct Unfinished {
    files: Vec<PathBuf>,
    folders: Vec<PathBuf>,
}

impl Unfinished {
    fn lock() -> MutexGuard<'static, Self> {
        UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes files and folders as far as possible. A failure cannot be reported here.
    fn take_away(&mut self, files: &[PathBuf], folders: &[PathBuf]) {
        for file in files {
            let _ = fs::remove_file(file);
        }
        for folder in folders {
            // This refuses a folder that is not empty, as intended.
            let _ = fs::remove_dir(folder);
        }
        self.files.retain(|file| !files.contains(file));
        self.folders.retain(|folder| !folders.contains(folder));
    }
}

/// Files of a run that are not yet in their folder.
///
/// ```
/// # let scratch = tempfile::tempdir()?;
/// # let dir = scratch.path().join("out");
/// use std::io::Write;
/// use cophase_files::trace::RunFiles;
///
/// let mut files = RunFiles::create(&dir)?;
/// let mut report = files.file("report.json")?;
/// report.write_all(b"{}")?;
/// report.flush()?;
/// assert!(!dir.join("report.json").exists());
/// let written = files.commit()?;
/// assert_eq!(written, [dir.join("report.json")]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct RunFiles {
    dir: PathBuf,
    /// Folders that were created here, innermost first.
    made: Vec<PathBuf>,
    /// Names whose temporaries are not yet in place, in the order requested.
    names: Vec<String>,
    /// Names of files of an earlier run that this run does not have.
    left_out: Vec<String>,
}

impl RunFiles {
    /// Creates the folder and its parents if they do not exist.
    ///
    /// # Errors
    /// The folder cannot be created, or a file is in its place.
    pub fn create(dir: impl AsRef<Path>) -> Result<Self, RunFilesError> {
        // Created first, so that its drop removes the folders that were made before a failure.
        let mut files = Self {
            dir: dir.as_ref().to_path_buf(),
            made: Vec::new(),
            names: Vec::new(),
            left_out: Vec::new(),
        };
        files.make_folder(&mut Unfinished::lock())?;
        Ok(files)
    }

    /// Creates the folder and its parents as far as they are missing.
    fn make_folder(&mut self, unfinished: &mut Unfinished) -> Result<(), RunFilesError> {
        let missing = (self.dir.ancestors())
            .take_while(|above| !above.as_os_str().is_empty() && !above.exists())
            .map(Path::to_path_buf)
            .filter(|folder| !self.made.contains(folder));
        let missing: Vec<_> = missing.collect();
        unfinished.folders.extend(missing.iter().cloned());
        self.made.extend(missing);
        fs::create_dir_all(&self.dir).map_err(|source| {
            let file = self.dir.ancestors().find(|above| above.is_file());
            RunFilesError::Io {
                operation: "create the folder",
                path: self.dir.clone(),
                source: file.map_or(source, |file| {
                    io::Error::new(
                        io::ErrorKind::AlreadyExists,
                        format!("{} is a file", file.display()),
                    )
                }),
            }
        })
    }

    /// Opens the temporary of file `name`, which must be a plain file name.
    ///
    /// Flush the writer and check the result before [`commit`](Self::commit). A dropped `BufWriter` discards the error of its last
    /// write, and a file that is too short would be put in place.
    ///
    /// # Errors
    /// The name is not a plain file name or was requested before, or the temporary cannot be created.
    pub fn file(&mut self, name: &str) -> Result<BufWriter<File>, RunFilesError> {
        let mut parts = Path::new(name).components();
        if !matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == name)
        {
            return Err(RunFilesError::Name(name.to_owned()));
        }
        if self.names.iter().any(|known| known == name) {
            return Err(RunFilesError::Twice(name.to_owned()));
        }
        let path = self.temporary(name);
        let mut unfinished = Unfinished::lock();
        let mut file = File::create(&path);
        if matches!(&file, Err(error) if error.kind() == io::ErrorKind::NotFound) {
            // Another process had created the folder, and has removed it since.
            self.make_folder(&mut unfinished)?;
            file = File::create(&path);
        }
        let file = file.map_err(|source| RunFilesError::Io {
            operation: "create",
            path: path.clone(),
            source,
        })?;
        unfinished.files.push(path);
        self.names.push(name.to_owned());
        Ok(BufWriter::with_capacity(1 << 16, file))
    }

    /// Leaves out a file that this run does not have: removes its temporary now, if it was begun, and a file of that name of an
    /// earlier run at the commit. So a folder never has files of two runs. Returns true if there is such an earlier file.
    pub fn leave_out(&mut self, name: &str) -> bool {
        if let Some(place) = self.names.iter().position(|known| known == name) {
            let temporary = self.temporary(name);
            Unfinished::lock().take_away(&[temporary], &[]);
            self.names.remove(place);
        }
        // A folder of this name was not written by a run.
        let is_there = fs::symlink_metadata(self.dir.join(name)).is_ok_and(|found| !found.is_dir());
        if is_there {
            self.left_out.push(name.to_owned());
        }
        is_there
    }

    /// Puts every file in place, replaces existing ones, and returns their paths in the order in which they were requested.
    ///
    /// # Errors
    /// A file cannot be put in place. Those before it are in place; it and those after it are removed.
    pub fn commit(mut self) -> Result<Vec<PathBuf>, RunFilesError> {
        let mut written = Vec::with_capacity(self.names.len());
        let mut unfinished = Unfinished::lock();
        while let Some(name) = self.names.first() {
            let path = self.dir.join(name);
            let temporary = self.temporary(name);
            fs::rename(&temporary, &path).map_err(|source| RunFilesError::Io {
                operation: "put in place",
                path: path.clone(),
                source,
            })?;
            unfinished.files.retain(|file| *file != temporary);
            self.names.remove(0);
            written.push(path);
        }
        for name in &self.left_out {
            let path = self.dir.join(name);
            if let Err(source) = fs::remove_file(&path)
                && source.kind() != io::ErrorKind::NotFound
            {
                return Err(RunFilesError::Io {
                    operation: "remove",
                    path,
                    source,
                });
            }
        }
        // The folder remains, even if no file was written.
        unfinished
            .folders
            .retain(|folder| !self.made.contains(folder));
        self.made.clear();
        Ok(written)
    }

    /// Removes the temporaries of all runs of this process, and the folders that were created for them. After that no run creates or
    /// commits a file: a thread that tries waits for the process to end.
    pub fn take_all_away() {
        let mut unfinished = Unfinished::lock();
        let (files, folders) = (unfinished.files.clone(), unfinished.folders.clone());
        unfinished.take_away(&files, &folders);
        std::mem::forget(unfinished);
    }

    fn temporary(&self, name: &str) -> PathBuf {
        // Two runs into one folder must not write into each other's temporaries.
        self.dir
            .join(format!(".{name}.{}.part", std::process::id()))
    }
}

impl Drop for RunFiles {
    fn drop(&mut self) {
        let files: Vec<_> = self.names.iter().map(|name| self.temporary(name)).collect();
        if !(files.is_empty() && self.made.is_empty()) {
            Unfinished::lock().take_away(&files, &self.made);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn names_in(dir: &Path) -> Vec<String> {
        let entries = fs::read_dir(dir).unwrap();
        let mut names: Vec<String> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_dropped_run_removes_its_folders() {
        let scratch = tempfile::tempdir().unwrap();
        let mut files = RunFiles::create(scratch.path().join("a/b")).unwrap();
        files.file("trace.csv").unwrap().write_all(b"half").unwrap();
        drop(files);
        assert!(names_in(scratch.path()).is_empty());
    }

    #[test]
    fn a_dropped_run_leaves_an_earlier_one_alone() {
        let scratch = tempfile::tempdir().unwrap();
        fs::write(scratch.path().join("trace.csv"), "earlier").unwrap();
        let mut files = RunFiles::create(scratch.path()).unwrap();
        files.file("trace.csv").unwrap().write_all(b"half").unwrap();
        drop(files);
        assert_eq!(names_in(scratch.path()), ["trace.csv"]);
        assert_eq!(
            fs::read(scratch.path().join("trace.csv")).unwrap(),
            b"earlier"
        );
    }

    /// If this fails, a folder has a new report beside the picture of an earlier scene, or a failed run removes files of an earlier one.
    #[test]
    fn files_that_a_run_leaves_out_are_removed_at_its_commit() {
        let scratch = tempfile::tempdir().unwrap();
        let run = |is_committed: bool| {
            let mut files = RunFiles::create(scratch.path()).unwrap();
            drop(files.file("report.json").unwrap());
            let left = ["torque.svg", "steps.fst", "trace.mcap"].map(|name| files.leave_out(name));
            if is_committed {
                files.commit().unwrap();
            }
            left
        };
        for name in ["notes.txt", "torque.svg"] {
            fs::write(scratch.path().join(name), "earlier").unwrap();
        }
        fs::create_dir(scratch.path().join("trace.mcap")).unwrap();
        assert_eq!(run(false), [true, false, false]);
        assert_eq!(
            names_in(scratch.path()),
            ["notes.txt", "torque.svg", "trace.mcap"]
        );
        assert_eq!(run(true), [true, false, false]);
        assert_eq!(
            names_in(scratch.path()),
            ["notes.txt", "report.json", "trace.mcap"]
        );
    }

    #[test]
    fn a_folder_somebody_else_uses_stays() {
        let scratch = tempfile::tempdir().unwrap();
        let dir = scratch.path().join("out");
        let files = RunFiles::create(&dir).unwrap();
        fs::write(dir.join("notes.txt"), "mine").unwrap();
        drop(files);
        assert_eq!(names_in(&dir), ["notes.txt"]);
    }

    /// If this fails, a shard of a campaign that is interrupted removes the new folder in which another shard is about to begin, and that
    /// one fails.
    #[test]
    fn a_folder_that_another_run_removed_is_created_again() {
        let scratch = tempfile::tempdir().unwrap();
        let dir = scratch.path().join("a/b");
        let interrupted = RunFiles::create(&dir).unwrap();
        let mut files = RunFiles::create(&dir).unwrap();
        drop(interrupted);
        assert!(names_in(scratch.path()).is_empty());
        drop(files.file("one").unwrap());
        drop(files);
        assert!(names_in(scratch.path()).is_empty());
    }

    #[test]
    fn file_names_outside_the_folder_are_refused() {
        let scratch = tempfile::tempdir().unwrap();
        let mut files = RunFiles::create(scratch.path()).unwrap();
        for name in ["", ".", "..", "a/b", "../a", "/a", "a/"] {
            assert!(
                matches!(files.file(name), Err(RunFilesError::Name(_))),
                "{name}"
            );
        }
        let _first = files.file("a").unwrap();
        assert!(matches!(files.file("a"), Err(RunFilesError::Twice(_))));
    }

    #[test]
    fn an_error_names_the_path_and_the_operation() {
        let scratch = tempfile::tempdir().unwrap();
        let dir = scratch.path().join("taken");
        fs::write(&dir, "a file").unwrap();
        let message = RunFiles::create(&dir).unwrap_err().to_string();
        assert!(
            message.starts_with("cannot create the folder "),
            "{message}"
        );
        assert!(message.contains("taken"), "{message}");

        let mut files = RunFiles::create(scratch.path()).unwrap();
        drop(files.file("one").unwrap());
        drop(files.file("two").unwrap());
        drop(files.file("three").unwrap());
        // A folder that is not empty cannot be replaced by a file.
        fs::create_dir_all(scratch.path().join("two/inner")).unwrap();
        let message = files.commit().unwrap_err().to_string();
        assert!(
            message.starts_with("cannot put in place ") && message.contains("two"),
            "{message}"
        );
        assert_eq!(names_in(scratch.path()), ["one", "taken", "two"]);
    }
}
