/* What compilers expect of any environment. */
#include <stddef.h>

void *memcpy(void *restrict to, const void *restrict from, size_t n) {
    void *start = to;
    __asm__ volatile("rep movsb" : "+D"(to), "+S"(from), "+c"(n) : : "memory");
    return start;
}

void *memmove(void *to, const void *from, size_t n) {
    if ((size_t)((char *)to - (const char *)from) >= n) return memcpy(to, from, n);
    for (volatile char *t = to; n-- > 0;) t[n] = ((const char *)from)[n];
    return to;
}

void *memset(void *to, int value, size_t n) {
    void *start = to;
    __asm__ volatile("rep stosb" : "+D"(to), "+c"(n) : "a"(value) : "memory");
    return start;
}

int memcmp(const void *a, const void *b, size_t n) {
    const unsigned char *p = a, *q = b;
    for (size_t i = 0; i < n; ++i)
        if (p[i] != q[i]) return p[i] - q[i];
    return 0;
}

int bcmp(const void *a, const void *b, size_t n) {
    return memcmp(a, b, n);
}

/* Rust's own `alloc` names these, though nothing unwinds here. */
void rust_eh_personality(void) {}

void _Unwind_Resume(void) {
    for (;;) __asm__ volatile("cli; hlt");
}
