"""Compiles the evaluator's CUDA text to PTX by NVRTC, which needs no GPU: `nvrtc.py TEXT.cuda`, after `pip install nvidia-cuda-nvrtc-cu12`.

Prints the bytes of the PTX, and fails with NVRTC's words.
"""

import ctypes
import pathlib
import sys

import nvidia.cuda_nvrtc

KERNEL = """
extern "C" __global__ void hits(const unsigned int *words, const float *in, float *out, int n) {
    using namespace srbf_device;
    int i = blockIdx.x * blockDim.x + threadIdx.x;
    if (i >= n) { return; }
    SrbfMaterial material = srbf_material(words);
    SrbfView view = srbf_prepare(material, vec3(in[9 * i], in[9 * i + 1], in[9 * i + 2]));
    SrbfValue value = srbf_evaluate(material, view, vec3(in[9 * i + 3], in[9 * i + 4], in[9 * i + 5]));
    SrbfSample sample = srbf_sample(material, view, vec3(in[9 * i + 6], in[9 * i + 7], in[9 * i + 8]));
    vec3 albedo = srbf_albedo(material, view);
    out[4 * i] = value.value.x;
    out[4 * i + 1] = value.pdf;
    out[4 * i + 2] = sample.weight.x;
    out[4 * i + 3] = albedo.x;
}
"""

SHEET = """
extern "C" __global__ void sheet_hits(const unsigned int *words, const float *in, float *out) {
    using namespace srbf_device;
    int i = blockIdx.x * blockDim.x + threadIdx.x;
    SrbfSheetView view = srbf_sheet_prepare(srbf_sheet(words), vec3(in[9 * i], in[9 * i + 1], in[9 * i + 2]));
    SrbfValue value = srbf_sheet_evaluate(view, vec3(in[9 * i + 3], in[9 * i + 4], in[9 * i + 5]));
    SrbfSample sample = srbf_sheet_sample(view, vec3(in[9 * i + 6], in[9 * i + 7], in[9 * i + 8]));
    out[i] = value.value.x + sample.weight.x + srbf_half_albedo(view.transmitted).x;
}
"""


def main(path):
    folder = pathlib.Path(list(nvidia.cuda_nvrtc.__path__)[0]) / "lib"
    library = ctypes.CDLL(str(next(folder.glob("libnvrtc.so.*"))))
    text = pathlib.Path(path).read_text()
    source = (text + KERNEL + (SHEET if "srbf_sheet_sample" in text else "")).encode()
    program, size = ctypes.c_void_p(), ctypes.c_size_t()
    assert library.nvrtcCreateProgram(ctypes.byref(program), source, b"srbf.cu", 0, None, None) == 0
    options = (ctypes.c_char_p * 2)(b"--gpu-architecture=compute_75", b"--std=c++17")
    status = library.nvrtcCompileProgram(program, 2, options)
    library.nvrtcGetProgramLogSize(program, ctypes.byref(size))
    log = ctypes.create_string_buffer(size.value)
    library.nvrtcGetProgramLog(program, log)
    if status:
        sys.exit(log.value.decode())
    library.nvrtcGetPTXSize(program, ctypes.byref(size))
    ptx = ctypes.create_string_buffer(size.value)
    library.nvrtcGetPTX(program, ptx)
    assert b".entry hits" in ptx.value
    print(f"NVRTC: {len(ptx.value)} bytes of PTX")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
