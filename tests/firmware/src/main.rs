//! A preset in flash: loaded, prepared, evaluated and sampled on a processor of 32 bits, with checksums, instructions and stack
//! counted. On a computer with an operating system it prints the checksums alone, which are to be the same.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod count;
#[cfg(all(target_os = "none", target_arch = "arm"))]
#[path = "arm.rs"]
mod machine;
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
#[path = "riscv.rs"]
mod machine;
mod print;
mod road;

#[cfg(target_os = "none")]
#[path = "stack.rs"]
mod stack;

#[cfg(target_os = "none")]
mod reference;

/// The preset, as it lies in flash.
static MATERIAL: &[u8] = include_bytes!("../../../presets/garnet_red.srbf");

/// The same in codes of 8 bits: `srbf pack garnet_red -o tests/firmware/garnet_red_packed.srbf`.
static PACKED: &[u8] = include_bytes!("../garnet_red_packed.srbf");

/// A brushed surface with mirrors, and the same in codes: seeds of the attacks.
static BRUSHED: &[u8] = include_bytes!("../../../fuzz/seeds/material/mirrors");
static BRUSHED_PACKED: &[u8] = include_bytes!("../../../fuzz/seeds/material/mirrors-in-codes");

/// Prints all figures, line by line.
fn report() -> Result<(), &'static str> {
    let material = srbf_core::Material::from_bytes(MATERIAL).map_err(|_| "the preset is damaged")?;
    let packed = srbf_core::Material::from_bytes(PACKED).map_err(|_| "the packed preset is damaged")?;
    road::print_checksums("checksum", &material)?;
    road::print_checksums("packed sum", &packed)?;
    for (name, bytes) in [("brushed sum", BRUSHED), ("brushed, packed sum", BRUSHED_PACKED)] {
        let brushed = srbf_core::Material::from_bytes(bytes).map_err(|_| "the brushed surface is damaged")?;
        road::print_checksums(name, &brushed)?;
    }
    #[cfg(target_os = "none")]
    {
        count::print(&material)?;
        count::print_prepare("prepare, packed", &packed);
        stack::print(MATERIAL)?;
    }
    Ok(())
}

/// Reports, and ends the program.
#[cfg(target_os = "none")]
#[inline(never)]
fn run() -> ! {
    let status = match report() {
        Ok(()) => 0,
        Err(fault) => {
            print::text(fault);
            print::line();
            2
        }
    };
    machine::end(status)
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    print::text("panic\n");
    machine::end(1)
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    // The level beside vectors, where there are some.
    if let Err(fault) = srbf_core::Level::Scalar.set() {
        println!("{fault}");
    }
    match report() {
        Ok(()) => std::process::ExitCode::SUCCESS,
        Err(fault) => {
            println!("{fault}");
            std::process::ExitCode::from(2)
        }
    }
}
