//! The command that makes the picture on the page.

use crate::options::{Command, Options, Origin};
use crate::pipeline::constants::Change;
use std::path::{Component, Path};

/// The `render` command for these options and constants.
///
/// A model that was named by a path from the root, or from above this folder, is named by its last part: the page does not
/// tell where on the machine it stands. The command is then to be given in its folder.
pub fn render(model: &Path, options: &Options, changes: &[Change]) -> String {
    let model = shown(model);
    let stem = Path::new(&model).file_stem().unwrap_or_default();
    let picture = format!("{}.png", stem.to_string_lossy());
    let mut words = vec!["understory".to_owned(), "render".to_owned()];
    words.extend([quoted(&model), "-o".to_owned(), quoted(&picture)]);
    for entry in options.entries() {
        if entry.origin != Origin::Flag || !entry.row.commands.contains(&Command::Render) {
            continue;
        }
        words.push(if entry.row.is_switch() {
            format!("--{}", entry.row.key)
        } else {
            // `=`: a value may begin with a minus.
            format!("--{}={}", entry.row.key, quoted(entry.text))
        });
    }
    for change in changes {
        words.push(format!(
            "--set {}",
            quoted(&format!("{}={}", change.name, change.text))
        ));
    }
    words.join(" ")
}

/// A path without what it tells of the machine.
fn shown(path: &Path) -> String {
    let is_below = path
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let shown = if is_below {
        path.as_os_str()
    } else {
        path.file_name().unwrap_or(path.as_os_str())
    };
    shown.to_string_lossy().into_owned()
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_has_what_was_set_and_no_folder_of_the_machine() {
        let mut options = Options::default();
        options.set("eye", "-1,2,3", Origin::Flag).unwrap();
        options
            .set("samples", "8", Origin::Preset("draft"))
            .unwrap();
        let change = Change {
            name: "P.N".into(),
            text: "-3".into(),
        };
        assert_eq!(
            render(Path::new("/home/me/it's.rgg"), &options, &[change]),
            r"understory render 'it'\''s.rgg' -o 'it'\''s.png' --eye=-1,2,3 --set P.N=-3"
        );
        let plain = Options::default();
        assert_eq!(
            render(Path::new("m/p.rgg"), &plain, &[]),
            "understory render m/p.rgg -o p.png"
        );
    }
}
