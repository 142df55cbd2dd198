//! Films on many machines: a script for the Slurm scheduler.
//!
//! The script submits three jobs: the first makes one frame (and solves the light that all frames share), an array makes the
//! rest in parts, the last makes what is still missing and the film. Each does only what is not there yet, so any of them can
//! be killed and started again.

use crate::options::Options;
use crate::options::value::Renderer;
use std::fmt::Write;
use std::path::Path;

/// Tasks of the array, at most.
const MOST_TASKS: u32 = 100;

/// What the script is to do.
pub(super) struct Plan<'a> {
    /// The program.
    pub(super) program: &'a Path,
    /// The folder in which it was called.
    pub(super) folder: &'a Path,
    /// Its command line without its name, without `--slurm` and without `--frames`.
    pub(super) words: &'a [String],
    /// The file of the film, or the folder of its frames.
    pub(super) output: &'a Path,
    /// How many frames it has.
    pub(super) n_frames: u32,
    /// The options of the film.
    pub(super) options: &'a Options,
}

/// The script. It is its own job: with a word it does that part, without one it submits all parts.
pub(super) fn script(plan: &Plan<'_>) -> String {
    let words: Vec<String> = plan.words.iter().map(|word| quoted(word)).collect();
    let command = format!(
        "{} {}",
        quoted(&plan.program.to_string_lossy()),
        words.join(" ")
    );
    let n_tasks = plan.n_frames.min(MOST_TASKS);
    let mut solution = plan.output.as_os_str().to_owned();
    solution.push(".solution");
    // Frames that show different scenes share no light.
    let options = plan.options;
    let keys = options
        .key
        .value
        .as_ref()
        .map_or(&[][..], |keys| keys.frames());
    let is_one_scene = options.grow.value.is_none()
        && !options.turntable.value
        && keys
            .iter()
            .all(|key| key.step.is_none() && key.sun.is_none());
    // What is chosen is chosen by the first job, and kept beside the frames: the script does not know it.
    let is_chosen = options.time.value.is_some() || options.error.value.is_some();
    let is_named = is_chosen || plan.words.iter().any(|word| word.contains("solution"));
    let (save, read) = if options.renderer.value == Renderer::Photon && is_one_scene && !is_named {
        let file = quoted(&solution.to_string_lossy());
        (
            format!(" --save-solution {file}"),
            format!(" --solution {file}"),
        )
    } else {
        (String::new(), String::new())
    };
    let mut text = String::new();
    // Writing into a text does not fail.
    let _ = write!(
        text,
        "#!/bin/bash
# A film of {frames} frames on a cluster with Slurm. Submit it with: bash THIS-FILE [options of sbatch, such as --partition=NAME]
# What is done is kept: after a failure, submit it again.
#SBATCH --job-name=understory-fly
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
frames={frames} tasks={n_tasks}
case \"${{UNDERSTORY_PART:-submit}}\" in
submit)
    here=$(realpath \"$0\")
    first=$(UNDERSTORY_PART=first sbatch --parsable --export=ALL \"$@\" \"$here\")
    parts=$(UNDERSTORY_PART=part sbatch --parsable --export=ALL --kill-on-invalid-dep=yes --dependency=\"afterok:${{first%%;*}}\" --array=\"0-$((tasks - 1))\" \"$@\" \"$here\")
    last=$(UNDERSTORY_PART=last sbatch --parsable --export=ALL --kill-on-invalid-dep=yes --dependency=\"afterany:${{parts%%;*}}\" \"$@\" \"$here\")
    echo \"submitted ${{first%%;*}} (first frame), ${{parts%%;*}} (frames), ${{last%%;*}} (film)\"
    ;;
first)
    cd {folder}
    exec {command} --flicker 0 --frames 0..1{save}
    ;;
part)
    cd {folder}
    from=$((frames * SLURM_ARRAY_TASK_ID / tasks))
    until=$((frames * (SLURM_ARRAY_TASK_ID + 1) / tasks))
    exec {command} --flicker 0 --frames \"$from..$until\"{read}
    ;;
last)
    cd {folder}
    exec {command}{read}
    ;;
esac
",
        frames = plan.n_frames,
        folder = quoted(&plan.folder.to_string_lossy()),
    );
    text
}

/// A command line for the script: without the options that the script itself gives.
pub(super) fn without_parts(words: &[String]) -> Vec<String> {
    let mut kept = Vec::new();
    let mut words = words.iter();
    while let Some(word) = words.next() {
        let is_ours = |flag: &str| {
            word == flag
                || word
                    .strip_prefix(flag)
                    .is_some_and(|rest| rest.starts_with('='))
        };
        if ["--slurm", "--frames", "--flicker"]
            .into_iter()
            .any(is_ours)
        {
            if !word.contains('=') {
                words.next();
            }
            continue;
        }
        kept.push(word.clone());
    }
    kept
}

/// A word that a shell reads as it is.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Origin;

    #[test]
    fn words_of_the_shell_are_quoted_and_own_options_left_out() {
        let words = [
            "fly",
            "it's.rgg",
            "--frames",
            "1..2",
            "--slurm=j.sh",
            "--key",
            "time=0; time=1",
            "--flicker",
            "3",
        ];
        let words = without_parts(&words.map(str::to_owned));
        let quoted: Vec<String> = words.iter().map(|word| quoted(word)).collect();
        assert_eq!(
            quoted,
            ["fly", r"'it'\''s.rgg'", "--key", "'time=0; time=1'"]
        );
    }

    #[test]
    fn light_is_shared_where_all_frames_show_one_scene() {
        let script = |set: &[(&str, &str)]| {
            let mut options = Options::default();
            for (key, text) in set {
                options.set(key, text, Origin::Flag).unwrap();
            }
            script(&Plan {
                program: Path::new("/bin/understory"),
                folder: Path::new("/home/me/my films"),
                words: &["fly".into(), "m.rgg".into()],
                output: Path::new("a.mp4"),
                n_frames: 250,
                options: &options,
            })
        };
        let photon = ("renderer", "photon");
        let shared = script(&[photon, ("orbit", "true")]);
        assert!(
            shared.contains("--save-solution a.mp4.solution")
                && shared.contains("cd '/home/me/my films'")
        );
        assert!(shared.contains("frames=250 tasks=100"));
        // Where the first frame fails, nothing waits for ever.
        assert_eq!(
            shared
                .matches("--kill-on-invalid-dep=yes --dependency=")
                .count(),
            2
        );
        assert!(!script(&[photon, ("grow", "0..4")]).contains("solution"));
        assert!(!script(&[("orbit", "true")]).contains("solution"));
    }
}
