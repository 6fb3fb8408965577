//! Files of the page, which are part of the binary.

/// A file: its path below the page's address, its type, and its content.
pub(super) struct File {
    path: &'static str,
    pub(super) content_type: &'static str,
    pub(super) bytes: &'static [u8],
}

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SVG: &str = "image/svg+xml";
const WASM: &str = "application/wasm";
const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! files {
    ($($path:literal $kind:ident),* $(,)?) => {
        &[$(File {
            path: $path,
            content_type: $kind,
            bytes: include_bytes!(concat!("../../../scope/page/", $path)),
        }),*]
    };
}

const FILES: &[File] = files![
    "index.html" HTML,
    "icon.svg" SVG,
    "style.css" CSS,
    "app.js" SCRIPT,
    "circle.js" SCRIPT,
    "contact.js" SCRIPT,
    "controls.js" SCRIPT,
    "cursors.js" SCRIPT,
    "decimation.js" SCRIPT,
    "editor.css" CSS,
    "editor.js" SCRIPT,
    "editor-completion.js" SCRIPT,
    "editor-examples.js" SCRIPT,
    "editor-keys.js" SCRIPT,
    "editor-plot.js" SCRIPT,
    "editor-summary.js" SCRIPT,
    "editor-text.js" SCRIPT,
    "faults.js" SCRIPT,
    "history.js" SCRIPT,
    "html.js" SCRIPT,
    "keys.js" SCRIPT,
    "plots.js" SCRIPT,
    "preview.js" SCRIPT,
    "preview-worker.js" SCRIPT,
    "previews.js" SCRIPT,
    "program.wasm" WASM,
    "save.js" SCRIPT,
    "signals.js" SCRIPT,
    "socket.js" SCRIPT,
    "theme.js" SCRIPT,
    "timeline.js" SCRIPT,
    "toolbar.js" SCRIPT,
    "trigger.js" SCRIPT,
    "view.js" SCRIPT,
    "vendor/uPlot.iife.min.js" SCRIPT,
    "vendor/uPlot.min.css" CSS,
];

/// Returns the file at a path. The page itself has the empty path.
pub(super) fn find(path: &str) -> Option<&'static File> {
    let path = if path.is_empty() { "index.html" } else { path };
    FILES.iter().find(|file| file.path == path)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// If this fails, a part of the page is missing in the binary, and the page does not begin.
    #[test]
    fn every_file_of_the_page_is_in_the_binary() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../scope/page");
        let missing: Vec<String> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap())
            .filter(|entry| entry.file_type().unwrap().is_file())
            .map(|entry| entry.file_name().into_string().unwrap())
            // The editor without a controller is for tests.
            .filter(|name| !name.starts_with("editor-alone.") && name != "editor.html")
            .filter(|name| find(name).is_none())
            .collect();
        assert_eq!(missing, [""; 0]);
    }
}
