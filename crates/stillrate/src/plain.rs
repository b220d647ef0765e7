//! Configurations and states as plain structs that another language can hold: every field with its name and
//! description, in memory order.
//!
//! A configuration struct is declared with [`plain!`](crate::plain!), a state struct with [`reals!`](crate::reals!); both implement
//! [`Plain`]. A C header and a configuration as C source follow from that, without a second list of fields to keep in step.

use crate::reals::Lane;

/// Is told what a plain value consists of, field by field.
///
/// # Example
/// ```
/// use stillrate::{Outline, Plain, filters::Pt1State};
/// /// Writes a value as C does.
/// struct Source(String);
/// impl Outline for Source {
///     fn number(&mut self, value: f64) {
///         self.0 += &format!("{value:?}");
///     }
///     fn count(&mut self, value: u32) {
///         self.0 += &format!("{value}u");
///     }
///     fn array(&mut self, length: usize) {
///         self.0 += &format!("[{length}] = {{");
///     }
///     fn end_array(&mut self) {
///         self.0 += "}";
///     }
///     fn open(&mut self, name: &'static str, _about: &[&'static str]) {
///         self.0 += &format!("({name}){{ ");
///     }
///     fn field(&mut self, name: &'static str, _about: &[&'static str]) {
///         self.0 += &format!(", .{name} = ");
///     }
///     fn close(&mut self) {
///         self.0 += " }";
///     }
/// }
/// let mut source = Source(String::new());
/// Pt1State { level: 0.5, started: 1.0 }.outline(&mut source);
/// assert_eq!(source.0.replace("{ , ", "{ "), "(Pt1State){ .level = 0.5, .started = 1.0 }");
/// ```
pub trait Outline {
    /// A floating-point number.
    fn number(&mut self, value: f64);
    /// A count or choice.
    fn count(&mut self, value: u32);
    /// An array of so many items begins.
    fn array(&mut self, length: usize);
    /// The array ends.
    fn end_array(&mut self);
    /// A struct begins; `about` are the lines of its description.
    fn open(&mut self, name: &'static str, about: &[&'static str]);
    /// The next value is this field of the struct.
    fn field(&mut self, name: &'static str, about: &[&'static str]);
    /// The struct ends.
    fn close(&mut self);
}

/// A number, or an array or struct of plain values in C's memory layout; every bit pattern is a valid value.
///
/// # Example
/// ```
/// use stillrate::{Outline, Plain, filters::Pt1};
/// struct Fields(Vec<(&'static str, f64)>);
/// impl Outline for Fields {
///     fn number(&mut self, value: f64) {
///         self.0.last_mut().unwrap().1 = value;
///     }
///     fn field(&mut self, name: &'static str, _: &[&'static str]) {
///         self.0.push((name, 0.0));
///     }
///     fn count(&mut self, _: u32) {}
///     fn array(&mut self, _: usize) {}
///     fn end_array(&mut self) {}
///     fn open(&mut self, name: &'static str, _: &[&'static str]) {
///         assert_eq!(name, "Pt1");
///     }
///     fn close(&mut self) {}
/// }
/// let mut fields = Fields(Vec::new());
/// Pt1::<f64>::new(50.0, 8.0)?.outline(&mut fields);
/// assert_eq!(fields.0[0], ("period_s", 0.02));
/// # Ok::<(), stillrate::ConfigError>(())
/// ```
pub trait Plain: Copy {
    /// Describes the value.
    fn outline<O: Outline>(&self, outline: &mut O);
}

impl Plain for f32 {
    fn outline<O: Outline>(&self, outline: &mut O) {
        outline.number(f64::from(*self));
    }
}

impl Plain for f64 {
    fn outline<O: Outline>(&self, outline: &mut O) {
        outline.number(*self);
    }
}

impl Plain for u32 {
    fn outline<O: Outline>(&self, outline: &mut O) {
        outline.count(*self);
    }
}

impl<U: Plain, const N: usize> Plain for [U; N] {
    fn outline<O: Outline>(&self, outline: &mut O) {
        outline.array(N);
        for item in self {
            item.outline(outline);
        }
        outline.end_array();
    }
}

impl<T: Plain> Plain for Lane<T, 1> {
    fn outline<O: Outline>(&self, outline: &mut O) {
        self.0[0].outline(outline);
    }
}

/// Declares a configuration struct generic over its number type and implements [`Plain`] for it.
///
/// # Example
/// ```
/// use stillrate::plain;
/// plain! {
///     /// When to raise an alarm.
///     pub struct Alarm<T> {
///         /// Rate, deg/s.
///         pub threshold: T,
///         /// Samples in a row.
///         pub samples: u32,
///     }
/// }
/// let alarm = Alarm { threshold: 300.0_f32, samples: 5 };
/// assert_eq!(size_of_val(&alarm), 8); // what C holds: a float and a uint32_t
/// ```
#[macro_export]
macro_rules! plain {
    ($(#[doc = $about:literal])* $vis:vis struct $name:ident<T> { $($(#[doc = $field_about:literal])* pub $field:ident : $type:ty),+ $(,)? }) => {
        $(#[doc = $about])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(C)]
        $vis struct $name<T> { $($(#[doc = $field_about])* pub $field: $type),+ }
        $crate::outline! { $name [$($about),*] $($field [$($field_about),*])+ }
    };
}

/// Implements [`Plain`] for a struct from the names and descriptions of its fields.
#[doc(hidden)]
#[macro_export]
macro_rules! outline {
    ($name:ident [$($about:literal),*] $($field:ident [$($field_about:literal),*])+) => {
        impl<T: $crate::Plain> $crate::Plain for $name<T> {
            fn outline<O: $crate::Outline>(&self, outline: &mut O) {
                outline.open(stringify!($name), &[$($about),*]);
                $(
                    outline.field(stringify!($field), &[$($field_about),*]);
                    $crate::Plain::outline(&self.$field, outline);
                )+
                outline.close();
            }
        }
    };
}
