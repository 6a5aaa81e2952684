
#ifndef __CUDACC_RTC__
inline int srbf_check(const uint32_t *words, size_t count);
// Whether words are a sheet that this text can read, as `srbf_check` says it of a material; of its quarters too.
inline int srbf_check_sheet(const uint32_t *words, size_t count) {
    if (count < 21) { return -1; }
    const uint32_t magic[4] = {0x42525389u, 0x1a0a0d46u, 3u, 2u};
    for (int i = 0; i < 4; i++) {
        if (words[i] != magic[i]) { return i + 1; }
    }
    if (words[4] > 0x7fffffffu || words[4] % 4u != 0u || words[4] / 4u > count || words[4] < 84u) { return 5; }
    if (words[5] > 1u) { return 6; }
    const uint32_t shares = 0x52414853u, quarters[4] = {0x46455246u, 0x41525446u, 0x46455242u, 0x41525442u};
    if (words[10] != shares || words[11] != 32u) { return 11; }
    const size_t end = words[4] / 4u - 1;
    bool has[4] = {};
    for (size_t at = 20; at < end;) {
        if (at + 1 >= end || words[at + 1] > 4 * (end - at - 2)) { return int(at) + 2; }
        const size_t length = words[at + 1];
        bool is_known = (words[at] & 32u) != 0u;
        for (int i = 0; i < 4; i++) {
            if (words[at] != quarters[i]) { continue; }
            if (has[i] || (words[5] == 1u && i > 1)) { return int(at) + 1; }
            const int wrong = srbf_check(words + at + 2, (length + 3) / 4);
            if (wrong != 0) { return int(at) + 2 + (wrong > 0 ? wrong : 0); }
            if (words[at + 6] != length) { return int(at) + 7; }
            has[i] = is_known = true;
        }
        if (!is_known) { return int(at) + 1; }
        at += 2 + (length + 3) / 4;
    }
    if (!has[0] && !has[1] && !has[2] && !has[3]) { return 21; }
    // Where there are both halves, each has some of the draws.
    for (int side = 0; side < 2 - int(words[5]); side++) {
        if (!has[2 * side] || !has[2 * side + 1]) { continue; }
        for (int i = 0; i < 16; i++) {
            const uint32_t code = (words[12 + 4 * side + i / 4] >> (8 * (i % 4))) & 255u;
            if (code == 0u || code == 255u) { return 13 + 4 * side + i / 4; }
        }
    }
    return 0;
}
#endif
