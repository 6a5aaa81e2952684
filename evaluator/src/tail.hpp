
#ifndef __CUDACC_RTC__
// Whether words are a material that this text can read, before they are read: 0, or which word is wrong, from 1; -1 if there are too few.
// Then nothing outside is read, and every result is a number, whatever the directions. The checksum is not looked at.
inline int srbf_check(const uint32_t *words, size_t count) {
    if (count < 13) { return -1; }
    const uint32_t magic[2] = {0x42525389u, 0x1a0a0d46u};
    for (int i = 0; i < 2; i++) {
        if (words[i] != magic[i]) { return i + 1; }
    }
    if (words[2] != 2u && words[2] != 3u) { return 3; }
    if (words[3] > 1u) { return 4; }
    // The last word may be there in part, but in version 3.
    if (words[4] > 0x7fffffffu || (size_t(words[4]) + 3) / 4 > count || (words[2] == 3u && words[4] % 4u != 0u)) { return 5; }
    if (words[5] < 1u || words[5] > 1024u) { return 6; }
    if (words[6] < 1u || words[6] > 64u) { return 7; }
    if (words[7] > words[6]) { return 8; }
    const int ring = words[2] == 2u ? 9 : 8;
    const bool is_line = words[3] == 0u;
    if (is_line && (words[ring] > words[6] - words[7] || words[ring] + words[6] > 64u)) { return ring + 1; }
    const uint32_t turns = words[ring + 1] & 65535u;
    if (!is_line && turns != 1u && turns != 2u && turns != 4u) { return ring + 2; }
    if (!is_line && (words[ring] < (turns == 4u ? 2u : 1u) || words[ring] > 64u)) { return ring + 1; }
    // The lobes first, before what stands behind them is looked at.
    const size_t angles = words[5], lobes = words[6], views = is_line ? angles : 1 + (angles - 1) * words[ring];
    const size_t head = is_line ? 4 : 6, row = is_line ? 5 * lobes + words[ring] : 6 * lobes;
    const size_t rows = 12 + angles + views * head, end_of_lobes = rows + views * row;
    const size_t end_of_all = size_t(words[4]) / 4;
    if (views > 4096 || end_of_lobes >= end_of_all) { return 5; }
    // Their numbers: in the ranges of the format.
    int wrong = 0;
    auto expect = [&](bool holds, size_t at) { wrong = holds || wrong != 0 ? wrong : int(at) + 1; };
    auto within = [&](size_t at, size_t n, float low, float high) {
        for (size_t end = at + n; at < end; at++) {
            const float number = srbf_bits(words[at]);
            // By its bits a NaN is seen whatever the options of the compiler.
            expect((words[at] & 0x7f800000u) != 0x7f800000u && number >= low && number <= high, at);
        }
    };
    const float pi = 3.14159274f;
    within(12, 1, 0.0f, 0.0f);
    for (size_t i = 13; i < 12 + angles; i++) { within(i, 1, srbf_bits(words[i - 1] + 1u), 0.5f * pi); }
    for (size_t view = 0; view < views; view++) {
        const size_t own = 12 + angles + view * head, first = rows + view * row;
        if (is_line) {
            // At the normal nothing depends on an azimuth.
            const float most = view == 0 ? 0.0f : 1.0f;
            within(own, 1, -6.64f * most, most);
            within(first, lobes, -pi * most, pi * most);
            within(first + 5 * lobes, words[ring], -0.5f * pi * most, 0.5f * pi * most);
        } else {
            within(own, 3, -10.0f, 10.0f);
            const float xx = srbf_bits(words[own]), xy = srbf_bits(words[own + 1]), yy = srbf_bits(words[own + 2]);
            const float middle = 0.5f * (xx + yy), half = 0.5f * (xx - yy), reach = srbf_sqrt(half * half + xy * xy);
            expect(middle - reach >= -5.0f && middle + reach <= 6.64f, own);
            within(first, 2 * lobes, -pi, pi);
            for (size_t k = first; k < first + lobes; k++) {
                const float x = srbf_bits(words[k]), y = srbf_bits(words[k + lobes]);
                expect(x * x + y * y <= pi * pi, k);
            }
        }
        within(own + head - 3, 1, -126.0f, 2.0f);
        within(own + head - 2, 2, -16.0f, 16.0f);
        const size_t numbers = first + (is_line ? 1 : 2) * lobes;
        within(numbers, lobes, -100.0f, 26.5f);
        within(numbers + lobes, lobes, -126.0f, 60.0f);
        within(numbers + 2 * lobes, 2 * lobes, -16.0f, 16.0f);
    }
    if (wrong != 0) { return wrong; }
    if (words[2] == 3u) {
        const uint32_t lobe = 0x45424f4cu, factors = 0x54434146u, spectra = 0x63657073u;
        if (words[10] != lobe || words[11] != 4 * (end_of_lobes - 12)) { return 11; }
        bool has_factors = false;
        for (size_t at = end_of_lobes; at + 1 < end_of_all;) {
            // A block that this text does not know and may not leave out begins with a capital letter.
            if (words[at] != factors && (words[at] & 32u) == 0u) { return int(at) + 1; }
            const size_t length = words[at + 1], next = at + 2 + (length + 3) / 4;
            if (length > 4 * (end_of_all - at) || next >= end_of_all) { return int(at) + 2; }
            if (words[at] == factors && (has_factors || length < 4)) { return int(at) + 1; }
            has_factors = has_factors || words[at] == factors;
            if (words[at] == spectra) {
                // As long as its head says, the numbers of its columns in range.
                if (length < 8) { return int(at) + 2; }
                const size_t kind = words[at + 2] & 255u, bits = (words[at + 2] >> 8) & 255u, count = words[at + 2] >> 16;
                if (kind > 1 || (bits != 8 && bits != 16) || count < 1 || count > 1024) { return int(at) + 3; }
                if (length != 12 + count * (2 + (kind == 0 ? 3 : 1) * bits / 8)) { return int(at) + 3; }
                auto half = [&](size_t i) { return (words[at + 4 + i / 2] >> (16 * (i % 2))) & 65535u; };
                for (size_t i = 0; i < count; i++) { expect(half(i) > (i == 0 ? 0u : half(i - 1)), at + 4 + i / 2); }
                const uint32_t low = half(count) << 16, unit = half(count + 1) << 16;
                const float least = srbf_bits(low), most = least + srbf_bits(unit) * (bits == 8 ? 255.0f : 65535.0f);
                expect((low & 0x7f800000u) != 0x7f800000u && unit < 0x7f800000u, at + 4 + count / 2);
                expect(least >= -1e6f && least <= 1e6f && most <= 1e6f, at + 4 + count / 2);
            }
            at = next;
        }
        if (wrong != 0) { return wrong; }
        if (!has_factors) { return 0; }
    }
    SrbfMaterial m = srbf_material(words);
    if (m.half_nodes == 0) { return words[2] == 2u && words[11] == 0u ? 0 : 12; }
    if (m.half_nodes < 2 || m.half_nodes > 32 || m.difference_nodes < 2 || m.difference_nodes > 32) { return 12; }
    if (m.azimuth_nodes < 1 || m.azimuth_nodes > 8) { return 12; }
    const size_t nodes = size_t(m.half_nodes) * m.difference_nodes * m.azimuth_nodes;
    if (size_t(m.nodes) + (m.node_bits == 8 ? (3 * nodes + 3) / 4 : nodes) >= end_of_all + (words[2] == 2u ? 1 : 0)) { return -1; }
    within(size_t(m.differences), 3 * views, -16.0f, 16.0f);
    const size_t largest = size_t(m.nodes) - 1;
    within(largest, 1, srbf_bits(words[largest]) == 0.0f ? 0.0f : 1e-20f, 8.0831f);
    return wrong;
}
#endif

} // namespace srbf_device_device
