/* A panic inside the library, which only a build for tests has, comes back as a status, in every thread. */
#include "check.h"
#include <pthread.h>

static void *panic_again(void *unused) {
    CHECK(strcmp(srbf_last_message(), "") == 0);
    for (int i = 0; i < 100; i++) {
        CHECK_STATUS(SRBF_STATUS_PANIC, srbf_status_panic());
    }
    return unused;
}

int main(void) {
    CHECK_STATUS(SRBF_STATUS_PANIC, srbf_status_panic());
    CHECK(strstr(srbf_last_message(), "planted") != NULL);
    pthread_t thread;
    CHECK(pthread_create(&thread, NULL, panic_again, NULL) == 0 && pthread_join(thread, NULL) == 0);
    /* The library goes on working. */
    CHECK(srbf_mixture_size(16) == SRBF_MIXTURE_SIZE_16);
    printf("panic: passed\n");
    return 0;
}
