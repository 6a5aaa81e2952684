
#ifndef __CUDACC_RTC__
// Whether words are a material that this text can read, before they are read: 0, or which word is wrong, from 1; -1 if there are too few.
// It checks that nothing outside is read. Whether the numbers mean something is what `srbf_core` and `srbf_material_load` check.
inline int srbf_check(const uint32_t *words, size_t count) {
    if (count < 13) { return -1; }
    const uint32_t magic[2] = {0x42525389u, 0x1a0a0d46u};
    for (int i = 0; i < 2; i++) {
        if (words[i] != magic[i]) { return i + 1; }
    }
    if (words[2] != 2u) { return 3; }
    if (words[3] > 1u) { return 4; }
    if (words[5] < 1u || words[5] > 1024u) { return 6; }
    if (words[6] < 1u || words[6] > 64u) { return 7; }
    if (words[7] > words[6]) { return 8; }
    if (words[3] == 0u && (words[9] > words[6] || words[9] + words[6] > 64u)) { return 10; }
    if (words[3] == 1u && (words[9] < 1u || words[9] > 64u)) { return 10; }
    if (words[3] == 1u && (words[10] < 1u || words[10] > 2u)) { return 11; }
    uint32_t half = words[11] & 65535u, difference = words[11] >> 16;
    if (words[11] != 0u && (half < 2u || half > 32u || difference < 2u || difference > 32u)) { return 12; }
    SrbfMaterial m = srbf_material(words);
    size_t end = size_t(half > 0u ? m.nodes : m.differences) + size_t(half) * difference;
    return end < count ? 0 : -1;
}
#endif

} // namespace srbf_device_device
