//! Table of the language's functions and classes: names, signatures, meaning. No behaviour.

/// A function of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FunctionId(pub u16);
/// A class of the language.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClassId(pub u16);
/// A constructor of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ConstructorId(pub u16);
/// A method or public member of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct MethodId(pub u16);
