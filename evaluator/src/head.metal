#include <metal_stdlib>
using namespace metal;
// Where the words of a material are: `device` memory, or `constant` if that is defined before.
#ifndef SRBF_DATA
#define SRBF_DATA const device uint *
#endif

