//! Shortens a story that breaks an invariant: lines that are not needed go. Source: Zeller, Hildebrandt, "Simplifying
//! and isolating failure-inducing input", 2002 (ddmin).

/// The shortest story found with a work of at most `most`: `trial` says whether a story still breaks the same invariant, and
/// what it has cost.
pub fn shorten(lines: &[String], most: u64, mut trial: impl FnMut(&[String]) -> (bool, u64)) -> Vec<String> {
    let (mut shortest, mut piece, mut work) = (lines.to_vec(), lines.len().div_ceil(2), 0);
    while piece > 0 && work < most {
        let (mut from, mut has_shrunk) = (0, false);
        while from < shortest.len() && work < most {
            let to = (from + piece).min(shortest.len());
            let without: Vec<String> = shortest[..from].iter().chain(&shortest[to..]).cloned().collect();
            let (fails, cost) = trial(&without);
            work += cost;
            if fails {
                (shortest, has_shrunk) = (without, true);
            } else {
                from = to;
            }
        }
        piece = match has_shrunk {
            true => piece.min(shortest.len()),
            false => piece / 2,
        };
    }
    shortest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_lines_that_are_needed_stay() {
        let lines: Vec<String> = (0..100).map(|number| number.to_string()).collect();
        let needs = |lines: &[String]| ["17", "18", "91"].iter().all(|word| lines.iter().any(|line| line == word));
        let trial = |lines: &[String]| (needs(lines), 1);
        assert_eq!(shorten(&lines, 1_000, trial), ["17", "18", "91"]);
        assert_eq!(shorten(&lines, 0, trial), lines, "no trial, no change");
    }
}
