/* The smallest program that uses the library: it links, runs, and finds the version that the header was made for. */
#include <srbf.h>
#include <stdio.h>
#include <string.h>

int main(void) {
    if (srbf_version() != SRBF_VERSION) {
        return 1;
    }
    printf("srbf %u.%u.%u: %s\n", (unsigned)srbf_version() / 10000, (unsigned)srbf_version() / 100 % 100, (unsigned)srbf_version() % 100,
           srbf_status_text(SRBF_STATUS_OK));
    return strcmp(srbf_last_message(), "") != 0;
}
