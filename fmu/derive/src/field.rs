//! A row of the table, from a field and its attribute.

use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use quote::{format_ident, quote, quote_spanned};
use syn::ext::IdentExt as _;
use syn::parse::{ParseStream, Parser as _};
use syn::spanned::Spanned as _;
use syn::{Attribute, Error, Field, LitStr, Meta, Result, Token, Type};

use crate::documentation;

/// What an attribute is called, and the constructor of Real variables of that name; others put their type in front.
const ATTRIBUTES: [&str; 7] =
    ["parameter", "calculated_parameter", "input", "output", "local", "input_clock", "output_clock"];

/// Why a type is none of a variable.
pub(crate) const NO_TYPE: &str =
    "the type of a variable is f64, f32, an integer from i8 to u64, bool, String or an enum with derive(Choice)";

/// The row of a field; none without an attribute of ours.
pub(crate) fn row(field: &Field) -> Result<Option<TokenStream>> {
    let ours = |attribute: &&Attribute| ATTRIBUTES.iter().any(|name| attribute.path().is_ident(name));
    let mut attributes = field.attrs.iter().filter(ours);
    let Some(attribute) = attributes.next() else { return Ok(None) };
    if let Some(second) = attributes.next() {
        return Err(Error::new_spanned(second, "a field is one variable"));
    }
    let settings = Settings::read(attribute)?;
    let access = Access::of(field)?;
    let role = attribute.path().require_ident()?.to_string();
    Ok(Some(settings.row(&role, field, &access)?))
}

/// What the attribute says.
#[derive(Default)]
struct Settings {
    name: Option<LitStr>,
    unit: Option<LitStr>,
    start: Option<TokenStream>,
    interval: Option<TokenStream>,
    /// Whatever else: methods of a declaration, with their arguments.
    refinements: Vec<(Ident, TokenStream)>,
}

impl Settings {
    fn read(attribute: &Attribute) -> Result<Self> {
        let mut settings = Self::default();
        match &attribute.meta {
            Meta::Path(_) => {}
            Meta::List(list) => (|input: ParseStream<'_>| settings.read_all(input)).parse2(list.tokens.clone())?,
            Meta::NameValue(pair) => return Err(Error::new_spanned(pair, "settings stand in parentheses")),
        }
        Ok(settings)
    }

    fn read_all(&mut self, input: ParseStream<'_>) -> Result<()> {
        while !input.is_empty() {
            let key: Ident = input.parse()?;
            let value = value(input)?;
            let text = || syn::parse2::<LitStr>(value.clone());
            let given_before = match key.to_string().as_str() {
                "name" => self.name.replace(text()?).is_some(),
                "unit" => self.unit.replace(text()?).is_some(),
                "start" => self.start.replace(value).is_some(),
                "interval" => self.interval.replace(value).is_some(),
                _ => {
                    let twice = self.refinements.iter().any(|(other, _)| *other == key);
                    self.refinements.push((key.clone(), value));
                    twice
                }
            };
            if given_before {
                return Err(Error::new_spanned(&key, format!("{key} is given twice")));
            }
            if !input.is_empty() {
                input.parse::<Token![,]>()?;
            }
        }
        Ok(())
    }

    fn row(self, role: &str, field: &Field, access: &Access) -> Result<TokenStream> {
        let span = field.span();
        let own = field.ident.as_ref().map(|name| name.unraw().to_string()).unwrap_or_default();
        let name = self.name.as_ref().map_or(own, LitStr::value);
        let text = documentation(&field.attrs);
        let text = if text.is_empty() { name.clone() } else { text };
        let is_real = access.kind == Kind::Real;
        let is_clock = role.ends_with("_clock");
        if let Some(unit) = self.unit.as_ref().filter(|_| !is_real || is_clock) {
            return Err(Error::new_spanned(unit, "only f64 and f32 have a unit"));
        }
        if is_clock && access.kind != Kind::Boolean {
            return Err(Error::new(span, "a clock is a bool: whether it ticks"));
        }
        if let Some(interval) = self.interval.as_ref().filter(|_| role != "input_clock") {
            return Err(Error::new_spanned(interval, "only an input clock has an interval"));
        }
        let settable = matches!(role, "parameter" | "input" | "input_clock");
        let takes_start = settable && !is_clock;
        if let Some(start) = self.start.as_ref().filter(|_| !takes_start) {
            return Err(Error::new_spanned(start, format!("no {role} has a start value: the model calculates it")));
        }
        let constructor = access.constructor(role, span)?;
        let mut arguments = vec![quote!(#name)];
        if is_real && !is_clock {
            let unit = self.unit.as_ref().map_or_else(|| "1".to_owned(), LitStr::value);
            arguments.push(quote!(#unit));
        }
        arguments.extend(access.enumeration());
        if takes_start {
            arguments.push(access.start(self.start));
        }
        if role == "input_clock" {
            arguments.push(self.interval.unwrap_or_else(|| quote!(::fmu_export::ClockInterval::Triggered)));
        }
        arguments.push(quote!(#text));
        let mut refinements = access.refinements();
        if role == "local" {
            refinements.push(quote!(.local()));
        }
        refinements.extend(self.refinements.into_iter().map(|(key, value)| quote!(.#key(#value))));
        let accessors = access.accessors(settable);
        Ok(quote!(::fmu_export::Variable::<Self>::#constructor(#(#arguments),*) #(#refinements)* #accessors))
    }
}

/// What follows a key: the tokens behind `=` up to the next comma, those in parentheses, or nothing.
fn value(input: ParseStream<'_>) -> Result<TokenStream> {
    if input.peek(syn::token::Paren) {
        let group: Group = input.parse()?;
        return Ok(group.stream());
    }
    if !input.peek(Token![=]) {
        return Ok(TokenStream::new());
    }
    let equals: Token![=] = input.parse()?;
    let mut tokens = TokenStream::new();
    while !input.is_empty() && !input.peek(Token![,]) {
        tokens.extend([input.parse::<TokenTree>()?]);
    }
    if tokens.is_empty() {
        return Err(Error::new_spanned(equals, "a value is missing"));
    }
    // One expression, whatever it is made of.
    let is_one = tokens.clone().into_iter().count() == 1;
    Ok(if is_one { tokens } else { TokenTree::Group(Group::new(Delimiter::None, tokens)).into() })
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Real,
    Integer,
    Boolean,
    Text,
    Enumeration,
}

/// How a field is read and written.
struct Access {
    kind: Kind,
    /// The last name of its type.
    type_name: String,
    of: Type,
    field: Ident,
}

impl Access {
    fn of(field: &Field) -> Result<Self> {
        let mut of = &field.ty;
        // A macro hands types on in groups.
        while let Type::Group(syn::TypeGroup { elem, .. }) | Type::Paren(syn::TypeParen { elem, .. }) = of {
            of = elem;
        }
        let refused = || Error::new_spanned(of, NO_TYPE);
        let Type::Path(path) = of else { return Err(refused()) };
        let type_name = path.path.segments.last().map(|it| it.ident.to_string()).unwrap_or_default();
        let kind = match type_name.as_str() {
            "f64" | "f32" => Kind::Real,
            "i8" | "u8" | "i16" | "u16" | "i32" | "u32" | "i64" | "u64" => Kind::Integer,
            "bool" => Kind::Boolean,
            "String" => Kind::Text,
            "isize" | "usize" | "i128" | "u128" | "char" => {
                return Err(refused());
            }
            _ => Kind::Enumeration,
        };
        let name = field.ident.clone().unwrap_or_else(|| Ident::new("field", Span::call_site()));
        Ok(Self { kind, type_name, of: of.clone(), field: name })
    }

    /// The constructor of a row: `integer_parameter` for an integer where a Real has `parameter`.
    fn constructor(&self, role: &str, span: Span) -> Result<Ident> {
        let prefix = match self.kind {
            _ if role.ends_with("_clock") => "",
            Kind::Real => "",
            Kind::Integer => "integer_",
            Kind::Boolean => "boolean_",
            Kind::Text => "string_",
            Kind::Enumeration => "enumeration_",
        };
        let role = match role {
            "calculated_parameter" if self.kind != Kind::Real => {
                return Err(Error::new(span, "a calculated parameter is a f64 or f32"));
            }
            // A local variable is an output that only shows.
            "local" => "output",
            other => other,
        };
        Ok(format_ident!("{prefix}{role}", span = span))
    }

    fn enumeration(&self) -> Option<TokenStream> {
        let of = &self.of;
        (self.kind == Kind::Enumeration).then(|| quote!(<#of as ::fmu_export::Choice>::TYPE))
    }

    /// The start value; that of an enumeration is the name of an item.
    fn start(&self, given: Option<TokenStream>) -> TokenStream {
        let of = &self.of;
        match (self.kind, given) {
            (Kind::Real, None) => quote!(0.0),
            (Kind::Integer, None) => quote!(0),
            (Kind::Boolean, None) => quote!(false),
            (Kind::Text, None) => quote!(""),
            (Kind::Enumeration, None) => quote!(1),
            (Kind::Enumeration, Some(item)) => {
                let name = item.to_string();
                let name = name.strip_prefix("r#").unwrap_or(&name);
                quote_spanned!(item.span()=> <#of as ::fmu_export::Choice>::TYPE.number_of(#name))
            }
            // What the type cannot hold is an error there.
            (Kind::Integer, Some(number)) => quote_spanned!(number.span()=> {
                const START: #of = #number;
                ::core::assert!(START as i128 <= i64::MAX as i128, "the start is beyond the largest i64");
                START as i64
            }),
            (Kind::Real, Some(number)) => quote_spanned!(number.span()=> {
                const START: #of = #number;
                START as f64
            }),
            (_, Some(value)) => value,
        }
    }

    /// What the type says beside the kind.
    fn refinements(&self) -> Vec<TokenStream> {
        match (self.kind, self.type_name.as_str()) {
            (Kind::Real, "f32") => vec![quote!(.single())],
            (Kind::Integer, name) => {
                let bits = name.trim_start_matches(['i', 'u']);
                let width = format_ident!("{}Int{bits}", if name.starts_with('u') { "U" } else { "" });
                vec![quote!(.width(::fmu_export::IntegerWidth::#width))]
            }
            _ => Vec::new(),
        }
    }

    /// The accessors. What is written is within the bounds of the type: the exporter checks it before.
    fn accessors(&self, settable: bool) -> TokenStream {
        let (field, of) = (&self.field, &self.of);
        let (get, set) = match self.kind {
            Kind::Real => (quote!(m.#field as f64), quote!(v as #of)),
            Kind::Integer if self.type_name == "u64" => {
                (quote!(if m.#field > i64::MAX as u64 { i64::MAX } else { m.#field as i64 }), quote!(v as #of))
            }
            Kind::Integer => (quote!(m.#field as i64), quote!(v as #of)),
            Kind::Boolean => (quote!(m.#field), quote!(v)),
            Kind::Text => (quote!(m.#field.clone()), quote!(v)),
            Kind::Enumeration => {
                let get = quote!(::fmu_export::Choice::number(&m.#field));
                let set = quote!(match ::fmu_export::Choice::of(v) {
                    ::core::option::Option::Some(item) => item,
                    ::core::option::Option::None => return,
                });
                (get, set)
            }
        };
        if settable { quote!(.access(|m| #get, |m, v| m.#field = #set)) } else { quote!(.get(|m| #get)) }
    }
}
