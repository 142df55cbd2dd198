//! Public fields of library objects: pairs of methods that are not called by name.

use super::{ClassId, MethodId};

/// A public field of a library class.
#[derive(Clone, Copy, Debug)]
pub struct LibraryField {
    /// Reads it.
    pub getter: MethodId,
    /// Writes it.
    pub setter: MethodId,
}

/// The public field `name` of a class or of what it extends.
pub fn field_named(class: ClassId, name: &str) -> Option<LibraryField> {
    let &(_, getter, setter) = FIELDS
        .iter()
        .find(|(owner, getter, _)| class.is_a(*owner) && getter.signature().name == name)?;
    Some(LibraryField { getter, setter })
}

/// Class, getter, setter of every public field; the getter's name is the field's.
#[rustfmt::skip]
static FIELDS: &[(ClassId, MethodId, MethodId)] = &[
    (ClassId::Tuple3d, MethodId::TupleX, MethodId::TupleSetX), (ClassId::Tuple3d, MethodId::TupleY, MethodId::TupleSetY),
    (ClassId::Tuple3d, MethodId::TupleZ, MethodId::TupleSetZ), (ClassId::Matrix, MethodId::Matrix00, MethodId::MatrixSet00),
    (ClassId::Matrix, MethodId::Matrix01, MethodId::MatrixSet01), (ClassId::Matrix, MethodId::Matrix02, MethodId::MatrixSet02),
    (ClassId::Matrix, MethodId::Matrix03, MethodId::MatrixSet03), (ClassId::Matrix, MethodId::Matrix10, MethodId::MatrixSet10),
    (ClassId::Matrix, MethodId::Matrix11, MethodId::MatrixSet11), (ClassId::Matrix, MethodId::Matrix12, MethodId::MatrixSet12),
    (ClassId::Matrix, MethodId::Matrix13, MethodId::MatrixSet13), (ClassId::Matrix, MethodId::Matrix20, MethodId::MatrixSet20),
    (ClassId::Matrix, MethodId::Matrix21, MethodId::MatrixSet21), (ClassId::Matrix, MethodId::Matrix22, MethodId::MatrixSet22),
    (ClassId::Matrix, MethodId::Matrix23, MethodId::MatrixSet23), (ClassId::Matrix, MethodId::Matrix30, MethodId::MatrixSet30),
    (ClassId::Matrix, MethodId::Matrix31, MethodId::MatrixSet31), (ClassId::Matrix, MethodId::Matrix32, MethodId::MatrixSet32),
    (ClassId::Matrix, MethodId::Matrix33, MethodId::MatrixSet33), (ClassId::RGBAShader, MethodId::ShaderRed, MethodId::ShaderSetRed),
    (ClassId::RGBAShader, MethodId::ShaderGreen, MethodId::ShaderSetGreen), (ClassId::RGBAShader, MethodId::ShaderBlue, MethodId::ShaderSetBlue),
    (ClassId::RGBAShader, MethodId::ShaderAlpha, MethodId::ShaderSetAlpha),
];

impl MethodId {
    /// Whether it is a public field's getter or setter, or an operator: not callable by name.
    pub fn is_hidden(self) -> bool {
        let is_operator = !self
            .signature()
            .name
            .starts_with(|c: char| c.is_alphabetic());
        is_operator
            || FIELDS
                .iter()
                .any(|&(_, getter, setter)| self == getter || self == setter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_inherited() {
        let x = field_named(ClassId::Spectrum3d, "x").map(|f| f.getter);
        assert_eq!(x, Some(MethodId::TupleX));
        assert!(field_named(ClassId::Random, "x").is_none());
        assert!(
            MethodId::TupleX.is_hidden()
                && MethodId::VectorPlus.is_hidden()
                && !MethodId::ListAdd.is_hidden()
        );
    }
}
