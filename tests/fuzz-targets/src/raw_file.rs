//! A raw file, as ngspice or something that calls itself so left it: points have as many finite numbers as variables
//! were announced, and there are no more of them than bytes.

use videg::ngspice::RawReader;

use crate::Target;

pub(crate) const TARGET: Target = Target { name: "raw_file", check, seeds };

fn check(bytes: &[u8]) -> bool {
    let Ok(mut reader) = RawReader::new(bytes) else { return false };
    let width = reader.names().len();
    let (mut values, mut points) = (Vec::new(), 0);
    while let Ok(true) = reader.next_point(&mut values) {
        assert_eq!(values.len(), width);
        assert!(values.iter().all(|value| value.is_finite()));
        points += 1;
    }
    assert!(points <= reader.points());
    assert!(usize::try_from(points).unwrap() * width * 8 <= bytes.len(), "points from nowhere");
    true
}

fn seeds() -> Vec<Vec<u8>> {
    [(1, 1), (2, 3), (9, 2), (3, 4)].map(|(variables, points)| raw(variables, points)).to_vec()
}

fn raw(variables: u32, points: u32) -> Vec<u8> {
    let list: String = (0..variables).map(|index| format!("\t{index}\tv({index})\tvoltage\n")).collect();
    let header = format!(
        "Title: a title\nDate: now\nPlotname: Transient Analysis\nFlags: real\nNo. Variables: {variables}\n\
         No. Points: {points}       \nVariables:\n{list}Binary:\n"
    );
    let numbers = (0..variables * points).flat_map(|number| (f64::from(number) * 0.7).to_le_bytes());
    header.into_bytes().into_iter().chain(numbers).collect()
}
