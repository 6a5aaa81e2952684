// Answers of the C++ wrapper to many pairs of directions, one hit at a time, with the arguments and the protocol of pairs.c.
#include <cstdio>
#include <cstring>
#include <srbf.hpp>
#include <vector>

static bool is_right = true;
static void must(srbf::Status status) { is_right = is_right && !status; }

int main(int argc, char **argv) {
    if (argc != 3) return 2;
    std::vector<float> in;
    for (float numbers[4096]; const std::size_t got = std::fread(numbers, sizeof(float), 4096, stdin);) in.insert(in.end(), numbers, numbers + got);
    const std::size_t n = in.size() / 9;
    std::vector<float> out(14 * n);
    const bool is_sheet = std::strcmp(argv[2], "sheet") == 0, is_blend = std::strcmp(argv[2], "blend") == 0;
    srbf::Sheet sheet;
    srbf::Material material, other;
    std::vector<srbf_blend_part> parts;
    if (is_sheet || is_blend) must(sheet.load(argv[1]));
    else must(material.load(argv[1]));
    if (is_blend) {
        srbf_sheet_info info;
        must(sheet.query(info));
        must(material.from_bytes({info.quarters[0], info.quarter_byte_counts[0]}));
        must(other.from_bytes({info.quarters[1], info.quarter_byte_counts[1]}));
        const float second[3] = {0.3f, 0.24f, 0.18f};
        parts = {srbf::blend::part(material, 1), srbf::blend::part(other, 1)};
        for (int c = 0; c < 3; c++) parts[0].tint[c] = 0.7f, parts[1].tint[c] = second[c];
    }
    for (std::size_t i = 0; i < n && is_right; i++) {
        auto vector = [&](std::size_t row) { return srbf::Vec3{in[row * n + i], in[(row + 1) * n + i], in[(row + 2) * n + i]}; };
        const srbf::Vec3 wo = vector(0), wi = vector(3), u = vector(6);
        srbf::Vec3 value, albedo, transmitted;
        srbf_sample sample;
        float pdf;
        if (is_blend) {
            must(srbf::blend::sample_and_evaluate(parts, wo, u, sample, wi, value, pdf));
            must(srbf::blend::albedo(parts, wo, albedo));
        } else if (is_sheet) {
            must(sheet.evaluate_and_pdf(wo, wi, value, pdf));
            must(sheet.sample(wo, u, sample));
            must(sheet.albedos(wo, albedo, transmitted));
            if ((wo[2] < 0) != (wi[2] < 0)) albedo = transmitted;
        } else {
            must(material.sample_and_evaluate(wo, u, sample, wi, value, pdf));
            must(material.albedo(wo, albedo));
        }
        const float *d = sample.direction, *w = sample.weight;
        const float numbers[14] = {value[0], value[1], value[2], pdf, d[0], d[1], d[2], sample.pdf, w[0], w[1], w[2], albedo[0], albedo[1], albedo[2]};
        for (std::size_t row = 0; row < 14; row++) out[row * n + i] = numbers[row];
    }
    return is_right && std::fwrite(out.data(), sizeof(float), out.size(), stdout) == out.size() ? 0 : 1;
}
