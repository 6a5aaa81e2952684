"""Runs the evaluator text as shaders, and compares it with core.

    python shaders.py WRITE REFERENCE FOLDER

WRITE is the program that writes the text, REFERENCE the one that prints the numbers of core (evaluator/examples/reference.rs), FOLDER a place for what is
made, for exports, `constants-*.wgsl`, which are compiled alone, and for sheets, `sheet-*.srbf`. WGSL is compiled by naga, GLSL and HLSL by glslang to SPIR-V; all run by
Vulkan, on lavapipe where there is no GPU. Where no direction is, they have to give 0. It needs the packages wgpu and srbf_brdf, glslangValidator, and a Vulkan driver.
"""

import pathlib
import subprocess
import sys

import numpy as np
import wgpu

N = 4096
BOUNDS = {"value": 3e-4, "density": 3e-4, "direction": 2e-4, "density there": 5e-4, "weight": 5e-4, "albedo": 3e-4}

# The calls of a hit: type, name and expression of each value.
HITS = {
    "material": [
        ("SrbfMaterial", "m", "srbf_material(DATA)"),
        ("SrbfView", "v", "srbf_prepare(m, wo)"),
        ("SrbfValue", "f", "srbf_evaluate(m, v, wi)"),
        ("SrbfSample", "s", "srbf_sample(m, v, u)"),
        ("float", "power", "v.power"),
        ("vec3", "albedo", "srbf_albedo(m, v)"),
    ],
    "sheet": [
        ("SrbfSheet", "sheet", "srbf_sheet(DATA)"),
        ("SrbfSheetView", "v", "srbf_sheet_prepare(sheet, wo)"),
        ("SrbfValue", "f", "srbf_sheet_evaluate(v, wi)"),
        ("SrbfSample", "s", "srbf_sheet_sample(v, u)"),
        ("SrbfHalf", "h", "srbf_sheet_half(sheet, wo, (wo.z < 0.0) != (wi.z < 0.0))"),
        # Of both halves, if they are not black.
        ("float", "power", "v.reflected.view.power * step(0.0, v.reflected.view.wo.z) + v.transmitted.view.power * step(0.0, v.transmitted.view.wo.z)"),
        ("vec3", "albedo", "srbf_half_albedo(h)"),
    ],
    "blend": [
        ("SrbfMaterial", "m", "srbf_material(DATA)"),
        ("SrbfBlend", "b", "srbf_blend(m, VEC3(0.7, 0.7, 0.7), m, VEC3(0.3, 0.2, 0.1), wo)"),
        ("SrbfValue", "f", "srbf_blend_evaluate(b, wi)"),
        ("SrbfSample", "s", "srbf_blend_sample(b, u)"),
        ("float", "power", "srbf_blend_power(b.first_view, b.first_colour) * srbf_coat(1.5, wo, wi)"),
        ("vec3", "albedo", "srbf_blend_albedo(b)"),
    ],
    # The front of a sheet as a blend of its reflection and its transmission.
    "front": [
        ("SrbfSheet", "sheet", "srbf_sheet(DATA)"),
        ("SrbfMaterial", "m", "srbf_material(PLACE(sheet.front_reflection))"),
        ("SrbfMaterial", "other", "srbf_material(PLACE(sheet.front_transmission))"),
        ("SrbfBlend", "b", "srbf_blend(m, VEC3(0.7, 0.7, 0.7), other, VEC3(0.3, 0.24, 0.18), wo)"),
        ("SrbfValue", "f", "srbf_blend_evaluate(b, wi)"),
        ("SrbfSample", "s", "srbf_blend_sample(b, u)"),
        ("float", "power", "srbf_blend_power(b.first_view, b.first_colour) + srbf_blend_power(b.second_view, b.second_colour)"),
        ("vec3", "albedo", "srbf_blend_albedo(b)"),
    ],
}

WGSL = (
    """@group(0) @binding(0) var<storage, read> words: array<u32>;
@group(0) @binding(1) var<storage, read> given: array<f32>;
@group(0) @binding(2) var<storage, read_write> got: array<vec4f>;
fn srbf_word(data: u32, i: i32) -> u32 { return words[data + u32(i)]; }
""",
    """
fn given_vector(row: u32, i: u32) -> vec3f { return vec3f(given[row * 4096u + i], given[(row + 1u) * 4096u + i], given[(row + 2u) * 4096u + i]); }
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3u) {
    let i = id.x;
    let wo = given_vector(0u, i);
    let wi = given_vector(3u, i);
    let u = given_vector(6u, i);
    HIT
    got[4u * i] = vec4f(f.value, f.pdf);
    got[4u * i + 1u] = vec4f(s.wi, s.pdf);
    got[4u * i + 2u] = vec4f(s.weight, power);
    got[4u * i + 3u] = vec4f(albedo, 0.0);
}
""",
    lambda kind, name, value: f"let {name} = {value};".replace("DATA", "0u").replace("VEC3", "vec3f").replace("PLACE", "u32"),
)
GLSL = (
    """#version 450
layout(local_size_x = 64) in;
layout(std430, set = 0, binding = 0) readonly buffer Words { uint words[]; };
layout(std430, set = 0, binding = 1) readonly buffer Given { float given[]; };
layout(std430, set = 0, binding = 2) buffer Got { vec4 got[]; };
uint srbf_word(int data, int i) { return words[data + i]; }
""",
    """
vec3 given_vector(int row, int i) { return vec3(given[row * 4096 + i], given[(row + 1) * 4096 + i], given[(row + 2) * 4096 + i]); }
void main() {
    int i = int(gl_GlobalInvocationID.x);
    vec3 wo = given_vector(0, i);
    vec3 wi = given_vector(3, i);
    vec3 u = given_vector(6, i);
    HIT
    got[4 * i] = vec4(f.value, f.pdf);
    got[4 * i + 1] = vec4(s.wi, s.pdf);
    got[4 * i + 2] = vec4(s.weight, power);
    got[4 * i + 3] = vec4(albedo, 0.0);
}
""",
    lambda kind, name, value: f"{kind} {name} = {value};".replace("DATA", "0").replace("VEC3", "vec3").replace("PLACE", ""),
)
HLSL = (
    """[[vk::binding(0, 0)]] StructuredBuffer<uint> words;
[[vk::binding(1, 0)]] StructuredBuffer<float> given;
[[vk::binding(2, 0)]] RWStructuredBuffer<float4> got;
uint srbf_word(uint data, int i) { return words[data + uint(i)]; }
""",
    """
float3 given_vector(uint row, uint i) { return float3(given[row * 4096 + i], given[(row + 1) * 4096 + i], given[(row + 2) * 4096 + i]); }
[numthreads(64, 1, 1)] void main(uint3 id : SV_DispatchThreadID) {
    uint i = id.x;
    float3 wo = given_vector(0, i);
    float3 wi = given_vector(3, i);
    float3 u = given_vector(6, i);
    HIT
    got[4 * i] = float4(f.value, f.pdf);
    got[4 * i + 1] = float4(s.wi, s.pdf);
    got[4 * i + 2] = float4(s.weight, power);
    got[4 * i + 3] = float4(albedo, 0.0);
}
""",
    lambda kind, name, value: f"{kind.replace('vec3', 'float3')} {name} = {value};".replace("DATA", "0").replace("VEC3", "float3").replace("PLACE", ""),
)


def source(parts, text, hit):
    """A shader round the text."""
    before, after, line = parts
    return before + text + after.replace("HIT", "\n    ".join(line(*value) for value in HITS[hit]))


def worst(got, want):
    """Largest relative errors over the pairs. A value is relative to the largest channel, and to the value of the lobes without factors."""
    value, pdf, wi, there, weight, power, albedo = (got[:, a:b] for a, b in ((0, 3), (3, 4), (4, 7), (7, 8), (8, 11), (11, 12), (12, 15)))
    largest = lambda a: np.max(np.abs(a), axis=1, keepdims=True)
    same = largest(wi - want[:, 4:7]) < 1e-2
    there_is = want[:, 3:4] > 0
    density = np.where(there_is, want[:, 3:4], 1)
    errors = {
        # Of a quarter that is black nothing is expected.
        "value": np.max(largest(value - want[:, :3]) / np.where(there_is, np.maximum(largest(want[:, :3]), want[:, 3:4] * power), 1)),
        "density": np.max(np.abs(pdf - want[:, 3:4]) / density),
        "direction": np.max(largest(wi - want[:, 4:7])[same]),
        "density there": np.max((np.abs(there - want[:, 7:8]) / want[:, 7:8])[same]),
        "weight": np.max((largest(weight - want[:, 8:11]) / np.maximum(largest(want[:, 8:11]), power))[same]),
        "albedo": np.max(largest(albedo - want[:, 11:14]) / np.maximum(largest(want[:, 11:14]), power)),
    }
    # A lobe chosen at the very edge between two may be the other one.
    return errors, int(np.sum(~same))


class Shaders:
    """A device, and what compiles and runs there. `write` is the program that writes the text, `folder` a place for files."""

    def __init__(self, write, folder):
        self.write, self.folder = write, pathlib.Path(folder)
        self.adapter = wgpu.gpu.request_adapter_sync(power_preference="high-performance")
        self.device = self.adapter.request_device_sync()

    def spirv(self, language, code, *options):
        """The words of a shader that glslang compiles."""
        path, target = self.folder / f"main.{language}", self.folder / f"{language}.spv"
        path.write_text(code)
        command = ["glslangValidator", *options, "-V", "-S", "comp", "-e", "main", str(path), "-o", str(target)]
        subprocess.run(command, check=True, stdout=sys.stderr)
        return target.read_bytes()

    def pipelines(self, hit, content=None):
        """One of each language for the calls of a hit, with the text of a content: that of the same name, if none is given."""
        words = [] if hit == "material" else [content or hit]

        def own(language, parts):
            text = subprocess.run([self.write, language, *words], stdout=subprocess.PIPE, check=True, text=True).stdout
            return source(parts, text, hit)

        codes = {"wgsl": own("wgsl", WGSL), "glsl": self.spirv("glsl", own("glsl", GLSL)), "hlsl": self.spirv("hlsl", own("hlsl", HLSL), "-D")}
        module = lambda code: {"module": self.device.create_shader_module(code=code), "entry_point": "main"}
        return {name: self.device.create_compute_pipeline(layout="auto", compute=module(code)) for name, code in codes.items()}

    def ask(self, pipeline, words, given):
        """The numbers of N pairs: value and density, direction and density there, weight and power, albedo and 0."""
        storage, device = wgpu.BufferUsage.STORAGE, self.device
        buffers = [
            device.create_buffer_with_data(data=words, usage=storage),
            device.create_buffer_with_data(data=given.tobytes(), usage=storage),
            device.create_buffer(size=64 * N, usage=storage | wgpu.BufferUsage.COPY_SRC),
        ]
        entries = [{"binding": i, "resource": {"buffer": b, "offset": 0, "size": b.size}} for i, b in enumerate(buffers)]
        group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)
        encoder = device.create_command_encoder()
        work = encoder.begin_compute_pass()
        work.set_pipeline(pipeline)
        work.set_bind_group(0, group)
        work.dispatch_workgroups(N // 64)
        work.end()
        device.queue.submit([encoder.finish()])
        return np.frombuffer(device.queue.read_buffer(buffers[2]), "<f4").reshape(N, 16)


def main(write, program, folder):
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "python/tests"))
    from conftest import make_materials, reference, spread

    folder = pathlib.Path(folder)
    shaders = Shaders(write, folder)
    device, pipelines, ask = shaders.device, shaders.pipelines, shaders.ask
    print(shaders.adapter.info["device"], shaders.adapter.info["description"])

    for path in sorted(folder.glob("constants-*.wgsl")):
        device.create_shader_module(code=path.read_text())
        print(path.name)
    wo, wi, u = spread(N)
    # Numbers of which none makes a direction, in one vector of a row each.
    ends = np.array([np.nan, np.inf, -np.inf, 1e30, -1e30, 0, 7], dtype="<f4")
    random = np.random.default_rng(2)
    which = random.integers(0, 3, N)
    failed = False
    files = {"material": make_materials(folder), "sheet": {path.stem: path for path in sorted(folder.glob("sheet-*.srbf"))}}
    for hit, found in files.items():
        if hit == "sheet":
            # Viewers and lights stand on either side.
            wo[:, 2] *= np.where(np.arange(N) // 2 % 2 == 0, 1, -1)
            wi[:, 2] *= np.where(np.arange(N) // 4 % 2 == 0, 1, -1)
        given = np.ascontiguousarray(np.concatenate([wo, wi, u], axis=1).T, dtype="<f4")
        hostile = given.copy()
        for row in range(9):
            hostile[row] = np.where(which == row // 3, random.choice(ends, N), hostile[row])
        made = pipelines(hit)
        blends = pipelines("blend") if hit == "material" else {}
        for name, path in found.items():
            words = path.read_bytes()
            words += b"\0" * (-len(words) % 4)
            want = reference(path, wo, wi, u)
            for language, pipeline in made.items():
                errors, elsewhere = worst(ask(pipeline, words, given), want)
                got = ask(pipeline, words, hostile)
                is_nothing = np.all(got[which == 0, :4] == 0) and np.all(got[which == 1, :4] == 0) and np.all(got[which == 0, 7:11] == 0)
                # A blend of a material with itself is that material in another colour.
                blended = ask(blends[language], words, given)[:, :4] / [1.0, 0.9, 0.8, 1.0] if blends else want[:, :4]
                apart = np.max(np.abs(blended - want[:, :4]), axis=1) / np.maximum(np.max(np.abs(want[:, :3]), axis=1), want[:, 3] + 1e-20)
                is_nothing &= bool(np.max(apart) <= 2 * BOUNDS["value"])
                is_good = all(errors[key] <= bound for key, bound in BOUNDS.items()) and elsewhere <= 2 and np.isfinite(got).all() and is_nothing
                failed |= not is_good
                print(f"{'pass' if is_good else 'FAIL'} {name:14} {language}", *(f"{k} {v:.1e}" for k, v in errors.items()), f"other lobe {elsewhere}, hostile {is_nothing}")
    if failed:
        sys.exit(f"above the bounds {BOUNDS}, or something where no direction is")


if __name__ == "__main__":
    main(*sys.argv[1:4])
