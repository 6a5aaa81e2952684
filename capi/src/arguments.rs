//! Names of arguments, as the header has them: messages begin with the one that is wrong.

macro_rules! arguments {
    ($($argument:ident $name:literal)*) => {
        /// An argument of a function of the header, or a member of one.
        #[derive(Clone, Copy)]
        #[cfg_attr(not(feature = "fit"), allow(dead_code, reason = "functions of fits are not there"))]
        pub(crate) enum Argument {
            $($argument),*
        }

        #[cfg(feature = "std")]
        const NAMES: &[&str] = &[$($name),*];
    };
}

arguments! {
    A "a" Albedo "albedo" B "b" Block "block" Brdf "brdf" Bytes "bytes" Choice "choice" Count "count" Difference "difference"
    Diffuse "diffuse" Direction "direction" Environment "environment" Expanded "expanded" F "f" Factor "factor" Flat "flat" Frame "frame"
    Info "info" Integral "integral" Left "left" Light "light" Lobe "lobe" Lobes "lobes" Material "material" Materials "request->materials"
    Mixture "mixture" Mixtures "mixtures" Out "out" Part "part" Parts "parts" Path "path" Pdf "pdf" Primaries "primaries"
    Radiance "radiance" Reflected "reflected" Reflection "reflection" Report "report" Request "request" RequestPdf "request->pdf" RequestSize "request->size"
    RequestU "request->u" RequestValue "request->value" RequestWi "request->wi" RequestWo "request->wo" Rgb "rgb" Sample "sample"
    SamplesDirection "request->samples.direction" SamplesPdf "request->samples.pdf" SamplesWeight "request->samples.weight"
    Sampling "sampling" Settings "settings" Sheet "sheet" Size "size" Spectrum "spectrum" Storage "storage" StorageSize "storage_size"
    Table "table" Transmitted "transmitted" U "u" Value "value" Values "values" Wavelengths "wavelengths" Weight "weight" Wi "wi" Wo "wo"
}

#[cfg(feature = "std")]
impl Argument {
    /// The name of the argument of this number, from 1 on; 0 is none.
    pub fn name(number: i32) -> Option<&'static str> {
        NAMES.get(usize::try_from(number).ok()?.checked_sub(1)?).copied()
    }

    /// Its number.
    #[inline(always)]
    pub const fn number(self) -> i32 {
        self as i32 + 1
    }
}
