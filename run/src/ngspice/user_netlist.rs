//! A netlist of the user: read, checked and made ready for a run in step with the harvester.
//!
//! A netlist is a program: ngspice executes its `.control` sections, reads files that it names and loads libraries. Whatever could do more than
//! describe a circuit is refused, unless the user trusts the netlist. What describes another analysis is left out.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use super::NgspiceError;
use super::capacitance::PICO;
use super::live::{Job, SOURCES, number};
use super::netlist_cards::{self, Card, NetlistError};
use super::run::{CapacitanceSource, Run};
use super::template::{Values, template};

/// A netlist with `deg_left` or `deg_right`.
#[derive(Debug, Clone, PartialEq)]
pub struct UserNetlist {
    path: PathBuf,
    cards: Vec<String>,
    commands: Vec<String>,
    /// Names of elements as the user writes them, by their small letters.
    spelling: HashMap<String, String>,
    options: BTreeSet<String>,
    transient: Transient,
    is_trapezoidal: bool,
    notes: Vec<String>,
}

/// What a card `.tran` says of the run.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Transient {
    longest_step: Option<f64>,
    from_initial_conditions: bool,
}

/// Cards that describe a circuit.
const CIRCUIT: &str = "\
    .subckt .ends .model .param .func .global .ic .nodeset .options .option .opt .temp .if .elseif .else .endif";
/// Cards that ask for an analysis or for output: this run has its own.
const ANALYSES: &str = "\
    .tran .ac .dc .op .noise .tf .sens .pz .disto .sp .hb .print .plot .save .probe .measure .meas .four .fourier \
    .width .backanno .title";
/// First letters of elements.
const ELEMENTS: &str = "abcdefghijklmopqrstuvwxyz";
/// Types of models, those of code models included. Others may read files or start programs.
const MODELS: &str = "\
    r c l d npn pnp lpnp nmos pmos njf pjf nmf pmf sw csw urc ltra txl cpl vdmos vdmosn vdmosp nhfet phfet nsoi psoi \
    res cap ind gain summer mult divide limit climit ilimit pwl multi_input_pwl slew hyst int d_dt s_xfer aswitch \
    pswitch zener cmeter lmeter core lcouple sidiode capacitoric inductoric sine square triangle oneshot delay d_osc \
    adc_bridge dac_bridge bidi_bridge d_buffer d_inverter d_and d_nand d_or d_nor d_xor d_xnor d_dff";
/// Commands of a trusted netlist that this run replaces: analyses, output and the end.
const OWN_COMMANDS: &str = "\
    tran run resume step stop op ac dc noise tf sens pz disto fourier plot gnuplot hardcopy print write wrdata meas \
    save quit exit";
/// Memory that ngspice may take with such a netlist, bytes.
const MEMORY: u64 = 4 << 30;

impl UserNetlist {
    /// Largest netlist, files included, bytes.
    pub const LARGEST: u64 = netlist_cards::LARGEST;

    /// Reads the netlist at `path` with the files that it includes. With `is_trusted` it may include files from anywhere, and its control
    /// section counts.
    ///
    /// # Errors
    /// A file that cannot be read or is no text; a card that is refused: each with its file and line.
    pub fn read(path: &Path, is_trusted: bool) -> Result<Self, NetlistError> {
        let cards = netlist_cards::read(path, is_trusted)?;
        let mut netlist = Self {
            path: path.to_owned(),
            cards: Vec::new(),
            commands: Vec::new(),
            spelling: HashMap::new(),
            options: BTreeSet::new(),
            transient: Transient { longest_step: None, from_initial_conditions: true },
            is_trapezoidal: false,
            notes: Vec::new(),
        };
        netlist.take_all(&cards, is_trusted)?;
        Ok(netlist)
    }

    /// Name of the file, without its ending.
    pub fn name(&self) -> String {
        self.path.file_stem().map_or_else(|| "netlist".to_owned(), |stem| stem.to_string_lossy().into_owned())
    }

    /// What of the netlist is left out, for the user.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// A name as the netlist spells it: `X1.Rload` for `x1.rload`.
    pub fn spelled(&self, name: &str) -> String {
        let spelled = |part: &str| self.spelling.get(part).cloned().unwrap_or_else(|| part.to_owned());
        name.split('.').map(spelled).collect::<Vec<_>>().join(".")
    }

    /// The work of ngspice for a `run` from `capacitance` (left, right), F, on; the charge of membranes at `voltage`, V, is the scale
    /// of charges.
    pub(crate) fn job(&self, run: &Run, voltage: f64, capacitance: [f64; 2]) -> Result<Job, NgspiceError> {
        let values = run.values(CapacitanceSource::External, voltage, capacitance, &[])?;
        let membranes = values.render("<capacitance>\n")?;
        let mut netlist = vec![format!("* {}", self.name())];
        netlist.extend(membranes.text().lines().map(str::to_owned));
        netlist.extend(self.cards.iter().cloned());
        netlist.push(self.missing_options(&values)?);
        let [left, right] = capacitance.map(|c| c / PICO);
        netlist.push(format!(".ic v(videg_cl)={left:e} v(videg_cr)={right:e}"));
        netlist.push(".end".to_owned());
        Ok(Job {
            netlist,
            sources: SOURCES.map(str::to_owned).to_vec(),
            commands: self.commands.clone(),
            longest_step: self.transient.longest_step.unwrap_or(run.max_step),
            // Not the end of the run: there ngspice would end the analysis without a word.
            stop: 2.0 * run.until,
            from_initial_conditions: self.transient.from_initial_conditions,
            is_trapezoidal: self.is_trapezoidal,
            memory: Some(MEMORY),
        })
    }

    /// The options of our own netlists, but for those that the user has set.
    fn missing_options(&self, values: &Values) -> Result<String, NgspiceError> {
        let ours = values.render(template!("run_live.cir"))?;
        let card = ours.text().lines().find(|line| line.starts_with(".options")).unwrap_or_default();
        let words = card.split_whitespace().skip(1);
        let missing = words.filter(|word| word.split('=').next().is_some_and(|name| !self.options.contains(name)));
        Ok(missing.fold(".options".to_owned(), |all, word| all + " " + word))
    }

    fn take_all(&mut self, cards: &[Card], is_trusted: bool) -> Result<(), NetlistError> {
        let mut cards = cards.iter();
        while let Some(card) = cards.next() {
            match card.first().as_str() {
                ".end" => break,
                ".control" if is_trusted => self.control(&mut cards),
                ".control" => return Err(card.refused("commands are executed with --trust only")),
                ".subckt" if card.is_membrane() => {
                    // An exported file defines them, too.
                    cards.by_ref().find(|card| card.first() == ".ends");
                }
                _ => self.take(card, is_trusted)?,
            }
        }
        Ok(())
    }

    fn take(&mut self, card: &Card, is_trusted: bool) -> Result<(), NetlistError> {
        let first = card.first();
        if let Some(command) = card.text.strip_prefix("*#") {
            if !is_trusted {
                return Err(card.refused("commands are executed with --trust only"));
            }
            self.command(command.trim());
            return Ok(());
        }
        if card.text.starts_with('*') {
            return Ok(());
        }
        if first == ".tran" {
            self.tran(card);
        }
        if is_among(ANALYSES, &first) {
            if !matches!(first.as_str(), ".title" | ".tran" | ".save" | ".probe" | ".backanno") {
                self.notes.push(format!("{}: {first} is left out: the run has its own analysis", card.place()));
            }
            return Ok(());
        }
        if !is_trusted {
            check(card)?;
        }
        if matches!(first.as_str(), ".options" | ".option" | ".opt") {
            return self.set_options(card);
        }
        let name = card.text.split_whitespace().next().unwrap_or_default();
        self.spelling.insert(name.to_ascii_lowercase(), name.to_owned());
        self.cards.push(card.text.clone());
        Ok(())
    }

    fn tran(&mut self, card: &Card) {
        let words: Vec<_> = card.text.split_whitespace().skip(1).collect();
        self.transient.from_initial_conditions = words.iter().any(|word| word.eq_ignore_ascii_case("uic"));
        self.transient.longest_step = words.get(3).and_then(|word| number(word)).filter(|&step| step > 0.0);
    }

    fn set_options(&mut self, card: &Card) -> Result<(), NetlistError> {
        let text = card.text.to_ascii_lowercase().replace(" =", "=").replace("= ", "=");
        let mut kept = vec![".options"];
        for word in text.split_whitespace().skip(1) {
            let (name, value) = word.split_once('=').unwrap_or((word, ""));
            match name {
                "interp" => {
                    self.notes.push(format!("{}: option interp is left out: it hides time points", card.place()));
                    continue;
                }
                "maxord" if value != "1" && value != "2" => {
                    return Err(card.refused(&format!("maxord = {value}: the ledger of energies knows orders 1 and 2")));
                }
                "method" => self.is_trapezoidal = value.starts_with("trap"),
                _ => {}
            }
            self.options.insert(name.to_owned());
            kept.push(word);
        }
        self.cards.push(kept.join(" "));
        Ok(())
    }

    fn control<'a>(&mut self, cards: &mut impl Iterator<Item = &'a Card>) {
        for card in cards.take_while(|card| card.first() != ".endc") {
            self.command(card.text.trim());
        }
    }

    fn command(&mut self, command: &str) {
        let verb = command.split_whitespace().next().unwrap_or_default().to_ascii_lowercase();
        if is_among(OWN_COMMANDS, &verb) {
            self.notes.push(format!("{verb} of the control section is left out: the run has its own analysis"));
        } else if !verb.is_empty() && !verb.starts_with('*') {
            self.commands.push(command.to_owned());
        }
    }
}

/// Whether a list of words has this one; the empty word is in none.
fn is_among(words: &str, word: &str) -> bool {
    words.split_whitespace().any(|it| it == word)
}

/// Refuses a card that could do more than describe a circuit.
fn check(card: &Card) -> Result<(), NetlistError> {
    let first = card.first();
    if first.starts_with('.') {
        if !is_among(CIRCUIT, &first) {
            return Err(card.refused(&format!("{first} is no card that describes a circuit; allowed with --trust")));
        }
    } else if !first.starts_with(|letter| ELEMENTS.contains(letter)) {
        return Err(card.refused(&format!("{first} is no element; allowed with --trust")));
    }
    let text = card.text.to_ascii_lowercase();
    if let Some(parameter) = file_parameter(&text) {
        return Err(card.refused(&format!("{parameter} names a file; allowed with --trust")));
    }
    if first == ".model" {
        let kind = text.split_whitespace().nth(2).unwrap_or_default();
        let kind = kind.split('(').next().unwrap_or_default();
        let is_derived = kind.starts_with("ako:");
        if !is_derived && !is_among(MODELS, kind) {
            return Err(card.refused(&format!("models of type {kind} are allowed with --trust only")));
        }
    }
    Ok(())
}

/// The parameter that names a file or a program, if there is one.
fn file_parameter(text: &str) -> Option<&str> {
    const WORDS: [&str; 3] = ["file", "simulation", "process"];
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let parts = text.match_indices('=').map(|(end, _)| text[..end].trim_end());
    parts
        .map(|part| &part[part.rfind(|c| !is_part(c)).map_or(0, |at| at + 1)..])
        .find(|name| WORDS.iter().any(|word| name.contains(word)))
}

impl Card {
    /// Whether it begins the definition of a membrane, which this run replaces.
    fn is_membrane(&self) -> bool {
        let name = self.text.split_whitespace().nth(1).unwrap_or_default();
        ["deg_left", "deg_right"].iter().any(|own| name.eq_ignore_ascii_case(own))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn netlist(text: &str, is_trusted: bool) -> Result<UserNetlist, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my.cir");
        std::fs::write(&path, text).unwrap();
        let shown = folder.path().display().to_string();
        UserNetlist::read(&path, is_trusted).map_err(|error| error.to_string().replace(&shown, ""))
    }

    #[test]
    fn a_netlist_keeps_its_circuit_and_loses_its_analyses() {
        let text = "My circuit\nXl a 0 deg_left\nRLoad a\n* comment\n+ 0 {R}\n.param R=1k\n.tran 1u 1 0 2m\n.ac dec 1 1 10\n\
                    .options RELTOL=1e-5 method = trap\n.subckt DEG_LEFT p n\nC1 p n 1p\n.ends\n.end\nnot read\n";
        let found = netlist(text, false).unwrap();
        assert_eq!(
            found.cards,
            ["Xl a 0 deg_left", "RLoad a 0 {R}", ".param R=1k", ".options reltol=1e-5 method=trap"]
        );
        assert_eq!(found.transient, Transient { longest_step: Some(2e-3), from_initial_conditions: false });
        assert!(found.is_trapezoidal);
        assert_eq!(found.spelled("rload"), "RLoad");
        assert_eq!(found.notes.len(), 1, "{:?}", found.notes);
        let job = found.job(&Run::new(1.0, 1.4), 2000.0, [15e-12; 2]).unwrap();
        let options = &job.netlist[job.netlist.len() - 3];
        assert!(
            options.contains("gmin=1e-20") && !options.contains("reltol") && !options.contains("method"),
            "{options}"
        );
        assert_eq!(job.netlist.iter().filter(|line| line.starts_with(".subckt")).count(), 2);
    }

    #[test]
    fn what_could_do_more_than_describe_a_circuit_is_refused_with_its_line() {
        for (card, expected) in [
            (".control\nshell rm x\n.endc", "my.cir, line 2: .control: commands are executed with --trust only"),
            ("*#shell rm x", "my.cir, line 2: *#shell rm x: commands are executed with --trust only"),
            (".hdl x.va", "line 2: .hdl x.va: .hdl is no card that describes a circuit"),
            (".model t filesource (file=\"a\")", "line 2: .model t filesource (file=\"a\"): file names a file"),
            (".model t d_state(state_file = \"a\")", "state_file names a file"),
            (".model t d_cosim(simulation=\"a.so\")", "simulation names a file"),
            (".model t", "models of type  are allowed with --trust only"),
            (".model t table2d", "models of type table2d are allowed with --trust only"),
            (".options maxord=4", "maxord = 4: the ledger of energies knows orders 1 and 2"),
            ("!ls", "!ls is no element"),
        ] {
            let error = netlist(&format!("title\n{card}\n.end\n"), false).unwrap_err();
            assert!(error.contains(expected), "{card}: {error}");
        }
        let trusted = netlist("title\n.control\nset x=1\ntran 1 2\n.endc\n*#alter r1=2\n.end\n", true).unwrap();
        assert_eq!(trusted.commands, ["set x=1", "alter r1=2"]);
    }
}
