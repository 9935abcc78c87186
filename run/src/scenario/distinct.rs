//! What makes a run another one than the plain run of its case or case file.

use videg_model::Case;

use super::times::Times;
use super::{CaseFile, Request, Setting, preset, times};

/// The options of `request` that say something else than the `case` and the `file`: their names and values, as a user types them.
pub(super) fn options(request: &Request, file: &CaseFile, case: &Case, resolved: &Times) -> Vec<(String, String)> {
    let own_case = request.case.as_ref().filter(|_| file.name.is_some() && request.case != file.case);
    let named = own_case.map(|case| ("case".to_owned(), case.clone()));
    let is_other = |setting: &&Setting| match file.settings.iter().rfind(|there| there.name == setting.name) {
        Some(there) => canonical(&there.value) != canonical(&setting.value),
        None => !preset::has(case, setting),
    };
    let set = last_of_each(&request.settings).filter(is_other);
    let shown = |value: &str| if value.contains(['e', 'E']) { value.to_owned() } else { canonical(value) };
    let set = set.map(|setting| (setting.name.clone(), shown(&setting.value)));
    // A file that makes no sense alone says nothing.
    let plain = times::resolve(&Request::default(), file).ok();
    let of = |times: &Times| [vec![times.until], vec![times.step], times.window.to_vec()];
    let plain = plain.as_ref().map(of);
    let is_given = [request.until.is_some(), request.step.is_some(), request.window.is_some()];
    let times = ["until", "step", "window"]
        .into_iter()
        .zip(of(resolved))
        .enumerate()
        .filter(|(k, (_, values))| is_given[*k] && plain.as_ref().is_none_or(|plain| plain[*k] != *values));
    let times = times.map(|(_, (name, values))| {
        let shown: Vec<_> = values.iter().map(f64::to_string).collect();
        (name.to_owned(), shown.join(","))
    });
    named.into_iter().chain(set).chain(times).collect()
}

/// What `settings`, the last of a name, set other than the start values of the `case`.
pub(super) fn effective(settings: &[Setting], case: &Case) -> Vec<Setting> {
    let of_case = preset::settings(case);
    let counts =
        |setting: &&Setting| of_case.iter().any(|other| other.name == setting.name) || !preset::has(case, setting);
    let settings = last_of_each(settings).filter(counts);
    let mut settings: Vec<_> =
        settings.map(|setting| Setting { value: canonical(&setting.value), ..setting.clone() }).collect();
    settings.sort_by(|one, other| one.name.cmp(&other.name));
    settings
}

/// The settings that win: the last of each name.
pub(super) fn last_of_each(settings: &[Setting]) -> impl Iterator<Item = &Setting> {
    let is_last = |(k, one): &(usize, &Setting)| settings[k + 1..].iter().all(|later| later.name != one.name);
    settings.iter().enumerate().filter(is_last).map(|(_, setting)| setting)
}

/// A value that is a number in one form.
fn canonical(value: &str) -> String {
    let is_number = value.contains(['.', 'e', 'E']);
    let number = value.trim().parse::<f64>().ok().filter(|_| is_number);
    number.map_or_else(|| value.to_owned(), |number| number.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    /// The run of these settings and times on a case file with `restitution = 0.7` and an end at 20 s, or on none.
    fn run(has_file: bool, settings: &[&str], until: Option<f64>) -> Scenario {
        let text = "name = 'own'\nuntil = 20.0\n[set]\nmembrane.restitution = 0.7\n";
        let file = has_file.then(|| CaseFile::parse(text).unwrap());
        let settings = settings.iter().map(|text| Setting::parse(text).unwrap()).collect();
        Request { file, settings, until, ..Request::default() }.resolve().unwrap()
    }

    #[test]
    fn options_that_say_what_is_so_anyway_make_no_other_run() {
        for (has_file, settings, until, expected) in [
            (false, &[][..], None, ""),
            (false, &["membrane.restitution=0.60", "excitation.phase=0"], Some(100.0), ""),
            (false, &["membrane.restitution=0.7"], Some(10.0), "membrane.restitution=0.7 until=10"),
            (false, &["membrane.restitution=0.7", "membrane.restitution=0.6"], None, ""),
            (true, &["membrane.restitution=0.70"], Some(20.0), ""),
            (true, &["membrane.restitution=0.6"], None, "membrane.restitution=0.6"),
            (true, &["load.resistance=1e10"], Some(100.0), "load.resistance=1e10 until=100"),
        ] {
            let found = run(has_file, settings, until).distinct;
            let found: Vec<_> = found.iter().map(|(name, value)| format!("{name}={value}")).collect();
            assert_eq!(found.join(" "), expected, "{settings:?}");
        }
    }

    #[test]
    fn runs_with_the_same_values_have_the_same_effective_settings() {
        let plain = run(false, &[], None).effective;
        assert!(plain.iter().any(|it| it.name == "initial.ballPosition"), "{plain:?}");
        for same in [&["membrane.restitution=6e-1"][..], &["excitation.phase=0"], &["ball.mass=1", "ball.mass=3.5e-3"]]
        {
            let found = run(false, same, None).effective;
            let values = |settings: &[Setting]| settings.iter().map(|it| it.value.clone()).collect::<Vec<_>>();
            assert_eq!(values(&found), values(&plain), "{same:?}");
        }
        assert_ne!(run(true, &[], None).effective.len(), 0);
    }
}
