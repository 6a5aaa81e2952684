//! The languages, and the tokens of the text in each.

/// A language that the text is written out in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// GLSL: ES 3.0, and 3.30 and later.
    Glsl,
    /// WGSL, of WebGPU.
    Wgsl,
    /// HLSL, shader model 5 and later.
    Hlsl,
    /// Slang: the text of HLSL.
    Slang,
    /// CUDA C++: the text of C++.
    Cuda,
    /// C++17, for processors and CUDA.
    Cpp,
    /// The Metal shading language.
    Metal,
}

impl Language {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Glsl, Self::Wgsl, Self::Hlsl, Self::Slang, Self::Cuda, Self::Cpp, Self::Metal];

    /// Its name, as an option of the command line has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Glsl => "glsl",
            Self::Wgsl => "wgsl",
            Self::Hlsl => "hlsl",
            Self::Slang => "slang",
            Self::Cuda => "cuda",
            Self::Cpp => "cpp",
            Self::Metal => "metal",
        }
    }

    /// Its name in a sentence.
    pub(crate) const fn title(self) -> &'static str {
        match self {
            Self::Glsl => "GLSL (ES 3.0; 3.30 and later)",
            Self::Wgsl => "WGSL",
            Self::Hlsl => "HLSL (shader model 5 and later)",
            Self::Slang => "Slang",
            Self::Cuda => "CUDA",
            Self::Cpp => "C++17 and CUDA without the library",
            Self::Metal => "the Metal shading language",
        }
    }

    /// The usual end of a file's name.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Cuda => "cuh",
            Self::Cpp => "hpp",
            Self::Metal => "metal",
            _ => self.name(),
        }
    }

    /// The language of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|language| language.name() == name)
    }

    /// Whether it is C++ or next to it: floating-point literals end in `f`, and data are a pointer.
    pub(crate) const fn has_pointers(self) -> bool {
        matches!(self, Self::Cuda | Self::Cpp | Self::Metal)
    }

    /// What words of the text are replaced by.
    pub(crate) const fn words(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Glsl => &[
                ("FN ", ""),
                ("STRUCT", "struct"),
                ("DATA", "int"),
                ("UINT", "uint"),
                ("FLOAT", "uintBitsToFloat"),
            ],
            Self::Hlsl | Self::Slang => &[
                ("FN ", ""),
                ("STRUCT", "struct"),
                ("DATA", "uint"),
                ("UINT", "uint"),
                ("FLOAT", "asfloat"),
                ("vec3", "float3"),
            ],
            Self::Metal => &[
                ("FN", "inline"),
                ("STRUCT", "struct"),
                ("DATA", "SRBF_DATA"),
                ("UINT", "uint"),
                ("FLOAT", "as_type<float>"),
                ("vec3", "float3"),
            ],
            Self::Cuda | Self::Cpp => &[
                ("FN", "SRBF_FN"),
                ("STRUCT", "struct"),
                ("DATA", "const uint32_t *"),
                ("UINT", "uint32_t"),
                ("FLOAT", "srbf_bits"),
                // Not the names of <math.h>: a program may say `using namespace srbf`.
                ("sqrt", "srbf_sqrt"),
                ("exp2", "srbf_exp2"),
                ("log", "srbf_log"),
                ("abs", "srbf_abs"),
                ("floor", "srbf_floor"),
                ("min", "srbf_min"),
                ("max", "srbf_max"),
                ("clamp", "srbf_clamp"),
                ("dot", "srbf_dot"),
            ],
            Self::Wgsl => &[("FLOAT", "bitcast<f32>"), ("STRUCT", "struct")],
        }
    }

    /// What stands before the text.
    pub(crate) const fn head(self) -> &'static str {
        match self {
            Self::Cuda | Self::Cpp => include_str!("head.hpp"),
            Self::Metal => include_str!("head.metal"),
            Self::Glsl => GLSL,
            Self::Hlsl | Self::Slang | Self::Wgsl => "",
        }
    }

    /// What stands before the end of a text of sheets.
    pub(crate) const fn sheet_check(self) -> &'static str {
        match self {
            Self::Cuda | Self::Cpp => include_str!("sheet.hpp"),
            _ => "",
        }
    }

    /// What stands after it.
    pub(crate) const fn tail(self) -> &'static str {
        match self {
            Self::Cuda | Self::Cpp => include_str!("tail.hpp"),
            _ => "",
        }
    }
}

/// GLSL ES has no precision of floating-point numbers by itself, and one of whole numbers that is too low.
const GLSL: &str = "#ifdef GL_ES\nprecision highp float;\nprecision highp int;\n#endif\n\n";
