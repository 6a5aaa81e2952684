
#ifndef __CUDACC_RTC__
// Whether words are a material that this text can read, before they are read: 0, or which word is wrong, from 1; -1 if there are too few.
// It checks that nothing outside is read. Whether the numbers mean something is what `srbf_core` and `srbf_material_load` check.
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
    if (words[3] == 0u && (words[ring] > words[6] || words[ring] + words[6] > 64u)) { return ring + 1; }
    if (words[3] == 1u && (words[ring] < 1u || words[ring] > 64u)) { return ring + 1; }
    if (words[3] == 1u && (words[ring + 1] < 1u || words[ring + 1] > 2u)) { return ring + 2; }
    // The lobes first, before what stands behind them is looked at.
    const size_t angles = words[5], lobes = words[6], views = words[3] == 0u ? angles : 1 + (angles - 1) * words[ring];
    const size_t row = words[3] == 0u ? 5 * lobes + words[ring] : 6 * lobes;
    const size_t end_of_lobes = 12 + angles + views * ((words[3] == 0u ? 4 : 6) + row);
    const size_t end_of_all = size_t(words[4]) / 4;
    if (views > 4096 || end_of_lobes >= end_of_all) { return 5; }
    if (words[2] == 3u) {
        const uint32_t lobe = 0x45424f4cu, factors = 0x54434146u;
        if (words[10] != lobe || words[11] != 4 * (end_of_lobes - 12)) { return 11; }
        size_t at = end_of_lobes;
        while (at + 1 < end_of_all) {
            // A block that this text does not know and may not leave out begins with a capital letter.
            if (words[at] != factors && (words[at] & 32u) == 0u) { return int(at) + 1; }
            if (size_t(words[at + 1]) > 4 * (end_of_all - at)) { return int(at) + 2; }
            if (words[at] == factors) { break; }
            at += 2 + (size_t(words[at + 1]) + 3) / 4;
        }
        if (at + 1 >= end_of_all) { return 0; }
        if (at + 3 >= end_of_all) { return int(at) + 1; }
    }
    SrbfMaterial m = srbf_material(words);
    if (m.half_nodes == 0) { return words[2] == 2u && words[11] == 0u ? 0 : 12; }
    if (m.half_nodes < 2 || m.half_nodes > 32 || m.difference_nodes < 2 || m.difference_nodes > 32) { return 12; }
    if (m.azimuth_nodes < 1 || m.azimuth_nodes > 8) { return 12; }
    const size_t nodes = size_t(m.half_nodes) * m.difference_nodes * m.azimuth_nodes;
    return size_t(m.nodes) + (m.node_bits == 8 ? (3 * nodes + 3) / 4 : nodes) < end_of_all + (words[2] == 2u ? 1 : 0) ? 0 : -1;
}
#endif

} // namespace srbf_device_device
