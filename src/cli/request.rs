//! The command line becomes a request.
//!
//! Commands and paths are written out in [`args`](super::args); every option of a model comes from its row of the table of options.

use super::args::Action;
use crate::options::{Command, OptionRow, Options, Origin, Section, TABLE};
use clap::builder::styling::{AnsiColor, Styles};
use clap::{Arg, ArgAction, ArgMatches, CommandFactory, FromArgMatches, Parser};
use std::ffi::OsString;

/// What the user asks for.
#[derive(Debug)]
pub(super) struct Request {
    /// The command with its paths.
    pub action: Action,
    /// The options set by flags, over the defaults.
    pub flags: Options,
    /// The command line without the program's name.
    pub words: Vec<String>,
}

#[derive(Debug, Parser)]
#[command(
    name = "understory",
    version,
    about = "Grows plants and forests from growth grammars and renders them with its own light transport",
    after_help = "A file NAME.toml beside NAME.rgg (or the one in the folder) may hold the same options:\n  \
                  steps, seed, and under [camera], [render], [sky], [fly] what --help lists there.\n\
                  Flags win over it, it wins over the preset of --quality.\n\n\
                  Exit codes: 0 done; 1 the model has errors (or a check of `validate` fails); 2 usage; 3 the world failed (file, memory) or it was stopped.",
    styles = STYLES,
    max_term_width = 110
)]
struct Cli {
    #[command(subcommand)]
    action: Action,
}

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold())
    .placeholder(AnsiColor::Cyan.on_default());

/// The commands with their names.
const COMMANDS: [(&str, Command); 10] = [
    ("check", Command::Check),
    ("derive", Command::Derive),
    ("render", Command::Render),
    ("watch", Command::Watch),
    ("fly", Command::Fly),
    ("export", Command::Export),
    ("trade", Command::Trade),
    ("validate", Command::Validate),
    ("light", Command::Light),
    ("lsp", Command::Lsp),
];

impl Request {
    /// Reads a command line, the program's name first.
    ///
    /// # Errors
    /// What to print: the error, or the help that was asked for.
    pub(super) fn parse(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let mut cli = cli();
        let words: Vec<OsString> = words.into_iter().collect();
        let plain = words.iter().skip(1);
        let plain = plain.map(|word| word.to_string_lossy().into_owned());
        let plain: Vec<String> = plain.collect();
        let matches = cli.try_get_matches_from_mut(words)?;
        let action = Cli::from_arg_matches(&matches)?.action;
        let mut flags = Options::default();
        if let Some((name, given)) = matches.subcommand() {
            for row in TABLE.iter().filter(|row| knows(name, row)) {
                let Some(text) = given_text(given, row) else {
                    continue;
                };
                flags.set(row.key, &text, Origin::Flag).map_err(|error| {
                    // The usage line of this command, not that of the whole program.
                    let mut command = cli.find_subcommand(name).unwrap_or(&cli).clone();
                    command.error(clap::error::ErrorKind::ValueValidation, error)
                })?;
            }
        }
        Ok(Self {
            action,
            flags,
            words: plain,
        })
    }
}

impl Action {
    /// Which command it is.
    pub fn command(&self) -> Command {
        match self {
            Self::Check(_) => Command::Check,
            Self::Derive(_) => Command::Derive,
            Self::Render(_) => Command::Render,
            Self::Watch(_) => Command::Watch,
            Self::Fly(_) => Command::Fly,
            Self::Export(_) => Command::Export,
            Self::Trade(_) => Command::Trade,
            Self::Validate(_) => Command::Validate,
            Self::Light(_) => Command::Light,
            Self::Lsp(_) => Command::Lsp,
        }
    }
}

fn knows(command_name: &str, row: &OptionRow) -> bool {
    COMMANDS
        .iter()
        .any(|(name, command)| *name == command_name && row.commands.contains(command))
}

fn given_text(given: &ArgMatches, row: &OptionRow) -> Option<String> {
    if row.is_switch() {
        given.get_flag(row.key).then(|| "true".to_owned())
    } else {
        given.get_one::<String>(row.key).cloned()
    }
}

/// The commands with the options of the table added.
fn cli() -> clap::Command {
    let mut cli = Cli::command();
    for (name, _) in COMMANDS {
        cli = cli.mut_subcommand(name, |mut command| {
            for row in TABLE.iter().filter(|row| knows(name, row)) {
                command = command.arg(flag(row));
            }
            command
        });
    }
    cli
}

fn flag(row: &'static OptionRow) -> Arg {
    let heading = match row.section {
        Section::Model => "Model",
        Section::Camera => "Camera [camera]",
        Section::Render => "Picture [render]",
        Section::Sky => "Daylight [sky]",
        Section::Fly => "Flight [fly]",
        Section::Light => "Light on organs [light]",
    };
    let arg = Arg::new(row.key).long(row.key).help_heading(heading);
    if row.is_switch() {
        arg.action(ArgAction::SetTrue).help(row.doc)
    } else {
        // Coordinates may begin with a minus.
        arg.value_name(row.unit)
            .allow_hyphen_values(true)
            .help(format!("{} [default: {}]", row.doc, row.default))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn parse(line: &str) -> Result<Request, clap::Error> {
        Request::parse(format!("understory {line}").split(' ').map(OsString::from))
    }

    #[test]
    fn the_commands_are_well_formed() {
        cli().debug_assert();
    }

    #[test]
    fn flags_come_from_the_table() {
        let request =
            parse("fly m.rgg -o f --orbit --frames 2..4 --eye -1,-2,3 --seed -7").unwrap();
        assert_eq!(request.flags.eye.value, Some(DVec3::new(-1.0, -2.0, 3.0)));
        assert_eq!(
            (request.flags.seed.value, request.flags.orbit.value),
            (-7, true)
        );
        assert_eq!(request.flags.frames.value, Some(2..4));
        assert_eq!(request.flags.frames.origin, Origin::Flag);
        assert_eq!(request.flags.samples.origin, Origin::Default);
    }

    #[test]
    fn a_command_knows_only_its_own_options() {
        assert!(parse("derive m.rgg --samples 3").is_err());
        assert!(parse("render m.rgg -o a.png --orbit").is_err());
        assert!(parse("check m.rgg --steps 3").is_err());
    }

    #[test]
    fn impossible_values_are_usage_errors_that_say_what_is_possible() {
        for (flags, expected) in [
            (
                "--samples 0",
                "`samples` must be a whole number from 1 up, not `0`",
            ),
            ("--eye 1,NaN,2", "three finite numbers"),
            ("--fov 180", "less than 180"),
            ("--renderer radiance", "`radiosity`"),
            ("--smaples 3", "--samples"),
        ] {
            let error = parse(&format!("render m.rgg -o a.png {flags}")).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{flags}");
            assert!(error.to_string().contains(expected), "{flags}: {error}");
        }
        let error = parse("fly m.rgg -o f --frames 5..2")
            .unwrap_err()
            .to_string();
        assert!(error.contains("A less than B"), "{error}");
    }
}
