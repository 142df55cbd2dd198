//! The commands and their paths, as `clap` reads them.

use crate::pipeline::constants::Change;
use crate::pipeline::failure::Failure;
use crate::pipeline::project_files::Access;
use clap::{Args, Subcommand, ValueEnum};
use std::path::PathBuf;

/// A command with its paths.
#[derive(Debug, Subcommand)]
pub enum Action {
    /// Read and check a model; print every error and warning; write nothing
    Check(CheckArgs),
    /// Grow a model; print its graph, its counts or its bracketed string
    Derive(DeriveArgs),
    /// Grow a model and make one picture of it
    Render(RenderArgs),
    /// Make the picture, and make it again whenever an input changes
    Watch(WatchArgs),
    /// Make a film: the camera moves, the model grows, or both
    Fly(FlyArgs),
    /// Write the surfaces with the light on them as a mesh with vertex colours (glTF)
    Export(ExportArgs),
    /// Check the light transport against what is known on paper; print each number
    Validate(ValidateArgs),
    /// Measure error against time of every method on a model: table, plots, a page, presets
    Trade(TradeArgs),
    /// Count the light that each organ absorbs, reflects and lets through
    Light(LightArgs),
    /// Serve an editor (Language Server Protocol on standard input and output)
    Lsp(LspArgs),
}

/// The model.
#[derive(Debug, Args)]
pub struct ModelArg {
    /// The model: a `.rgg` file, a folder of them, or a packed GroIMP project (`.gsz`)
    pub model: PathBuf,
    /// Where files are that the model names otherwise: `C:/Users/me=data` (repeatable)
    #[arg(long, value_name = "FROM=TO")]
    pub path_map: Vec<String>,
    /// A folder that the model may use besides its own (repeatable)
    #[arg(long, value_name = "DIR")]
    pub allow_path: Vec<PathBuf>,
    /// Give a `const` or `static` number of the model another value (repeatable)
    #[arg(long, value_name = "NAME=NUMBER")]
    pub set: Vec<String>,
    /// Write the tables that the model draws (`chart`) into this folder, as CSV and SVG
    #[arg(long, value_name = "DIR")]
    pub charts: Option<PathBuf>,
}

impl ModelArg {
    /// The constants that are to have other values.
    pub fn changes(&self) -> Result<Vec<Change>, Failure> {
        let changes = self.set.iter().map(|text| Change::parse(text));
        let changes: Result<Vec<Change>, String> = changes.collect();
        changes.map_err(|message| Failure::Usage(format!("--set: {message}")))
    }

    /// What the model may use besides its own folder.
    pub fn access(&self) -> Result<Access, Failure> {
        Access::parse(&self.path_map, &self.allow_path, self.charts.as_deref())
    }
}

/// What all commands that run a model take.
#[derive(Debug, Args)]
pub struct Manners {
    /// Show no progress, no summary and no warnings
    #[arg(long)]
    pub quiet: bool,
    /// Print each option with its value and where it came from, and stop
    #[arg(long)]
    pub explain_options: bool,
}

/// What commands that light a scene take.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// Grow the model, print what light in its scene requires and what is left out, and stop
    #[arg(long)]
    pub explain_scene: bool,
}

/// `check`
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  understory check plant.rgg")]
pub struct CheckArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
}

/// What `derive` prints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Print {
    /// The graph, one node a line
    Tree,
    /// One line per node type, with its count
    Counts,
    /// The bracketed string
    String,
}

/// `derive`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory derive plant.rgg --steps 5 --print counts\n  \
                        understory derive plant.rgg --steps 5 --json counts.json\n\n\
                        What the model prints with `println` goes to standard output."
)]
pub struct DeriveArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// What to print of the grown graph
    #[arg(long, value_name = "WHAT", value_enum)]
    pub print: Option<Print>,
    /// Write step, counts, total, seconds, seed and hash of the graph to this file
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// Files with the light that all cameras share.
#[derive(Debug, Args)]
pub struct SolutionArgs {
    /// Take the light of photon mapping or radiosity from this file instead of solving it; refused if it is of anything else than this model
    #[arg(long, value_name = "FILE")]
    pub solution: Option<PathBuf>,
    /// Write the light of photon mapping or radiosity into this file, for other cameras
    #[arg(long, value_name = "FILE")]
    pub save_solution: Option<PathBuf>,
}

impl SolutionArgs {
    /// Whether a file is named.
    pub fn has_files(&self) -> bool {
        self.solution.is_some() || self.save_solution.is_some()
    }
}

/// `render`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory render forest.rgg -o forest.png\n  \
                        understory render plant.rgg --steps 9 -o plant.png --quality final --size 1920x1080\n  \
                        understory render plant.rgg -o plant.exr --eye 3,-4,2 --target 0,0,1 --sun 135,40\n\n\
                        A model without a camera is framed whole; one without a light stands in daylight on a plane.\n\
                        Ctrl-C stops and writes the picture with the samples so far."
)]
pub struct RenderArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// The picture: .png .jpg .webp (sRGB), .exr .hdr (linear radiance)
    #[arg(
        short,
        long,
        value_name = "FILE",
        required_unless_present_any = ["explain_options", "explain_scene"]
    )]
    pub output: Option<PathBuf>,
    /// Take what `--quality` stands for from this file, such as `understory trade` writes
    #[arg(long, value_name = "FILE.toml")]
    pub presets: Option<PathBuf>,
    /// Write what was done, and how long it took, to this file
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub light: SolutionArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub scene: SceneArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// `watch`
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  understory watch plant.rgg\n  \
                        understory watch plant.rgg --editor code\n  \
                        understory watch plant.rgg -o plant.png --quality draft\n\n\
                        Open the address that it prints in a browser: the picture follows every save, and can be turned, grown and lit there.\n\
                        Errors are shown and survived; the last good picture stays. Ctrl-C ends it.")]
pub struct WatchArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// Keep this picture up to date too: .png .jpg .webp (sRGB), .exr .hdr (linear radiance)
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Port of the page; the next free one if it is taken
    #[arg(long, value_name = "PORT", default_value_t = crate::watch::page::PORT)]
    pub port: u16,
    /// The command that opens a line of the model: `code`, or any with `{file}` and `{line}`; $VISUAL or $EDITOR otherwise
    #[arg(long, value_name = "COMMAND")]
    pub editor: Option<String>,
    /// Make the picture once, without a page, and stop
    #[arg(long)]
    pub once: bool,
    /// Write what was done, and how long it took, to this file, after each picture
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// `fly`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory fly forest.rgg --orbit -o forest.mp4\n  \
                        understory fly plant.rgg --grow 0..30 --flight-frames 250 -o growth.mp4\n  \
                        understory fly forest.rgg --key 'time=0 eye=0,-30,9; time=8 eye=0,30,4' -o flight.mp4\n  \
                        understory fly forest.rgg --orbit --flight-frames 240 --frames 0..60 -o frames\n\n\
                        The frames of FLIGHT.mp4 are kept in the folder FLIGHT.mp4.frames: a flight that was stopped goes on\n\
                        where it was, parts (--frames) can be made one by one or by several machines, and the film is written\n\
                        once all its frames are there. The folder can be removed then."
)]
pub struct FlyArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// Draw the path from above into this picture; without --output nothing else is made
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Put frames of the film, small and side by side, into this picture
    #[arg(long, value_name = "FILE", requires = "output")]
    pub sheet: Option<PathBuf>,
    /// Make nothing: write a script that makes the film on a cluster with Slurm
    #[arg(long, value_name = "JOB.sh", requires = "output")]
    pub slurm: Option<PathBuf>,
    /// The film: .mp4 (H.264), .gif, .png or .apng (animated PNG), .webp; a path without a suffix is a folder for frame-000000.png and so on
    #[arg(
        short,
        long,
        value_name = "FILE",
        required_unless_present_any = ["explain_options", "explain_scene", "plan"]
    )]
    pub output: Option<PathBuf>,
    /// Take what `--quality` stands for from this file, such as `understory trade` writes
    #[arg(long, value_name = "FILE.toml")]
    pub presets: Option<PathBuf>,
    /// Write what was done, and how long it took, to this file
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub light: SolutionArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub scene: SceneArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// `export`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory export room.rgg --renderer radiosity -o room.glb\n  \
                        understory export room.rgg --renderer radiosity --solution room.light -o room.glb\n\n\
                        The light of radiosity becomes colours at the corners of triangles, shown as they are by any viewer of\n\
                        glTF (its material is unlit), with the exposure and the tone curve of the picture that the camera\n\
                        sees. Shadows are as sharp as a thousandth of the scene; mirrors and glass show what is seen in them\n\
                        from straight above."
)]
pub struct ExportArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// The mesh
    #[arg(
        short,
        long,
        value_name = "FILE.glb",
        required_unless_present_any = ["explain_options", "explain_scene"]
    )]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub light: SolutionArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub scene: SceneArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// `trade`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory trade room.rgg -o room-trade\n  \
                        understory trade forest.rgg -o forest-trade --budget 1800\n  \
                        understory render room.rgg -o room.png --presets room-trade/presets.toml --quality draft\n\n\
                        Each method is tried with settings from cheap to dear and several seeds, and its pictures are compared with a\n\
                        long one without bias. Pictures are at most 240 pixels wide unless --size says otherwise; --renderer tries one\n\
                        method only. The folder holds index.html (open it in a browser), trade.csv, plots and presets.toml; the\n\
                        same command goes on where it was stopped, and with a larger --budget it adds to what is there."
)]
pub struct TradeArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// The folder for what is measured
    #[arg(
        short,
        long,
        value_name = "FOLDER",
        required_unless_present_any = ["explain_options", "explain_scene"]
    )]
    pub output: Option<PathBuf>,
    /// Seconds for the whole measurement, growth left out
    #[arg(long, value_name = "SECONDS", default_value_t = 300)]
    pub budget: u32,
    /// Other random numbers are tried so many times for each setting
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(2..=64))]
    pub seeds: u32,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub scene: SceneArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// `validate`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory validate\n  understory validate --only sky --seed 7 --json checks.json\n  \
                        understory validate --extremes --json extremes.json --page extremes.html\n\n\
                        Small scenes are looked at by the estimators that make the pictures, and the numbers compared with\n\
                        closed forms: configuration factors, Fresnel's equations, skies, furnaces, lamps.\n\
                        Exit codes: 0 all hold; 1 one differs, as happens to a right program once in a million\n\
                        seeds; 2 no check is called so; 3 a file could not be written, or it was stopped."
)]
pub struct ValidateArgs {
    /// Make only the checks whose names begin so
    #[arg(long, value_name = "NAME")]
    pub only: Option<String>,
    /// Make the checks at the extremes instead: huge, tiny, far, degenerate, empty, endless; cases C-1 to C-72
    #[arg(long)]
    pub extremes: bool,
    /// At the extremes, do in full what takes minutes and gigabytes: 1e9 samples, 1e8 photons
    #[arg(long, requires = "extremes")]
    pub full: bool,
    /// Write each check with what was found to this file
    #[arg(long, value_name = "FILE.json")]
    pub json: Option<PathBuf>,
    /// Write the checks at the extremes as a page for a browser
    #[arg(long, value_name = "FILE.html", requires = "extremes")]
    pub page: Option<PathBuf>,
}

/// `light`
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  understory light plant.rgg -o organs.csv\n  \
                        understory light plant.rgg --steps 9 -o organs.csv --organ-error 5%\n  \
                        understory light crop.rgg -o organs.csv --periodic 1.5,0.75 --sun 135,40\n\n\
                        One row for each organ: power absorbed, reflected, transmitted and received, in W, with standard errors,\n\
                        and the number of the plant that the organ belongs to: what hangs on one branch of the root. An endless\n\
                        plane is no plant; of its light only what falls round the model is counted. A model without a light stands in daylight, as in its pictures."
)]
pub struct LightArgs {
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub model: ModelArg,
    /// The table
    #[arg(
        short,
        long,
        value_name = "FILE.csv",
        required_unless_present_any = ["explain_options", "explain_scene"]
    )]
    pub output: Option<PathBuf>,
    /// Write what was done, and how long it took, to this file
    #[arg(long, value_name = "FILE.json")]
    pub report: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub scene: SceneArgs,
    #[command(flatten)]
    #[allow(missing_docs, reason = "see its type")]
    pub manners: Manners,
}

/// `lsp`
#[derive(Debug, Args)]
#[command(
    after_help = "Example, in Neovim:\n  vim.lsp.start({ name = 'understory', cmd = { 'understory', 'lsp' } })\n\n\
                        Shows errors as you type, what words mean, where they are declared, and what could stand there.\n\
                        `grammar/vscode` is an extension for Visual Studio Code."
)]
pub struct LspArgs {
    /// Talk over standard input and output, as always: editors add this flag
    #[arg(long)]
    pub stdio: bool,
}
