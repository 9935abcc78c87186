//! The derive macros of `fmu-export`, whose documentation describes them.
#![cfg_attr(test, allow(clippy::unwrap_used, reason = "a panic is how a test fails"))]

mod choice;
mod field;
mod variables;

use proc_macro::TokenStream;
use syn::{DeriveInput, Lit, Meta, parse_macro_input};

/// Gives a model the associated constant `VARIABLES`, the table of its variables: a row for each field that has one of the attributes
/// `parameter`, `calculated_parameter`, `input`, `output`, `local`, `input_clock` and `output_clock`, in the order of the fields.
///
/// - The documentation of a field, its first paragraph, is the description.
/// - `name = "..."`: without it, the name is that of the field. `unit = "..."`: of f64 and f32, without it 1.
/// - `start = ...`: of parameters and inputs. Without it the start is 0, false, an empty text or the first item; it is set after
///   `Slave::new`, whose values are overwritten. The start of an enumeration is the name of an item: `start = Compliant`.
/// - `interval = ...`: of an input clock, a `ClockInterval`; without it, it is triggered.
/// - Anything else is a method of `Declaration`: `min = 0.0`, `tunable`, `depends_on = &["u"]`, `partial_derivative(|m, known| ...)`. A value
///   behind `=` ends at the next comma; one that has commas stands in parentheses.
///
/// The types are f64, f32, the integers from i8 to u64, bool, String, and enums with `derive(Choice)`, each under its own name: an alias
/// is not seen through. The package must be called `fmu-export` in `Cargo.toml`.
#[proc_macro_derive(
    Variables,
    attributes(parameter, calculated_parameter, input, output, local, input_clock, output_clock)
)]
pub fn variables(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    variables::expand(&input).into()
}

/// Makes an `enum` without fields a choice among items, which a field of a model can have as its type. Items are numbered from 1 in their
/// order; their documentation describes them.
#[proc_macro_derive(Choice)]
pub fn choice(input: TokenStream) -> TokenStream {
    let input = parse_macro_input!(input as DeriveInput);
    choice::expand(&input).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// The first paragraph of a documentation: its lines with blanks in between, without the full stop.
fn documentation(attributes: &[syn::Attribute]) -> String {
    let line = |attribute: &syn::Attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            syn::Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value().trim().to_owned()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    let all: Vec<_> = attributes.iter().filter_map(line).collect();
    // A block comment is one attribute, whose lines may begin with stars.
    let lines = all.iter().flat_map(|text| text.lines()).map(|line| line.trim().trim_start_matches('*').trim());
    let lines: Vec<_> = lines.skip_while(|line| line.is_empty()).take_while(|line| !line.is_empty()).collect();
    let text = lines.join(" ");
    text.strip_suffix('.').unwrap_or(&text).to_owned()
}
