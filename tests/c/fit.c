/* Fitting from a table and from a function of the caller, saving, loading again; and the refusals.
 *
 *     fit FOLDER
 */
#define _POSIX_C_SOURCE 200809L
#include "check.h"
#include <pthread.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A diffuse surface with a gloss: f by the half vector, isotropic and reciprocal. */
static void gloss(void *user, const float *wi, const float *wo, float *f) {
    float h[3] = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
    float z = h[2] / sqrtf(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]), peak = *(const float *)user * expf(60 * (z - 1));
    f[0] = 0.2f + peak, f[1] = 0.1f + peak, f[2] = 0.05f + peak;
}

static void check_fit(const srbf_material *material, float height, float limit) {
    _Alignas(SRBF_MIXTURE_ALIGNMENT) unsigned char storage[SRBF_MIXTURE_SIZE_64];
    srbf_mixture *mixture;
    CHECK_OK(srbf_mixture_init(storage, sizeof storage, &mixture));
    const float wo[3] = {0.5f, 0, 0.8660254f};
    CHECK_OK(srbf_material_prepare(material, wo, mixture));
    uint64_t state = 5;
    double error = 0, norm = 0;
    for (int i = 0; i < 4000; i++) {
        float wi[3], value[3], f[3];
        direction(&state, wi);
        gloss(&height, wi, wo, f);
        CHECK_OK(srbf_mixture_evaluate(mixture, wi, value));
        error += pow((double)(value[0] - f[0] * wi[2]), 2), norm += pow((double)(f[0] * wi[2]), 2);
    }
    printf("relative L2 %.3f\n", sqrt(error / norm));
    CHECK_MEAN(sqrt(error / norm) < (double)limit);
}

/* Where the system gives no threads, a fit is refused and nothing panics; in a process of its own, as threads are started once. */
static void test_without_threads(void) {
    pid_t child = fork();
    CHECK(child >= 0);
    if (child == 0) {
        float height = 0.5f;
        srbf_material *material = NULL;
        /* A stack that no address space has room for. */
        CHECK(setenv("RUST_MIN_STACK", "1125899906842624", 1) == 0);
        for (int i = 0; i < 2; i++) {
            CHECK_STATUS(SRBF_STATUS_OTHER, srbf_fit_brdf(NULL, gloss, &height, &material, NULL));
            CHECK(strstr(srbf_last_message(), "no threads") != NULL && material == NULL);
        }
        _exit(0);
    }
    int status;
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

/* Work of the fits. With SHORT it is a fraction, and their errors are not held. */
#ifdef SHORT
enum { FITTED_VIEWS = 2, STARTS = 1, STEPS = 2, SAMPLES = 50, FITS_IN_CHILD = 1 };
#else
enum { FITTED_VIEWS = 6, STARTS = 2, STEPS = 20, SAMPLES = 400, FITS_IN_CHILD = 2 };
#endif

/* Settings of a fit that takes about a second. */
static srbf_fit_settings quick(void) {
    srbf_fit_settings settings;
    CHECK_OK(srbf_fit_settings_default(&settings));
    settings.lobes = 6, settings.squeezed_lobes = 2, settings.mirrored_pairs = 0, settings.views = FITTED_VIEWS;
    settings.starts = STARTS, settings.steps = STEPS, settings.exchanges = 0;
    for (int i = 0; i < 3; i++) {
        settings.factor_nodes[i] = 0;
    }
    return settings;
}

/* Seconds after which a child has hung; a fit with one lobe takes one. */
#define HUNG 300

/* The child fits with one lobe, and ends; a hang ends it by a signal. */
static void fit_in_child(void) {
    pid_t child = fork();
    CHECK(child >= 0);
    if (child == 0) {
        alarm(HUNG);
        float height = 0.5f;
        srbf_fit_settings settings = quick();
        settings.lobes = 1, settings.squeezed_lobes = 0;
        for (int i = 0; i < FITS_IN_CHILD; i++) {
            srbf_material *material = NULL;
            CHECK_OK(srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
            CHECK_OK(srbf_material_free(material));
        }
        _exit(0);
    }
    int status;
    CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void *fit_in_thread(void *settings) {
    float height = 0.5f;
    srbf_material *material = NULL;
    CHECK_OK(srbf_fit_brdf((const srbf_fit_settings *)settings, gloss, &height, &material, NULL));
    CHECK_OK(srbf_material_free(material));
    return NULL;
}

/* At any of its calls, a child that fits at once: its parent's threads are not there, and the one that it has is one of them. */
static void forking(void *user, const float *wi, const float *wo, float *f) {
    float height = 0.5f;
    gloss(&height, wi, wo, f);
    if (__atomic_exchange_n((int *)user, 1, __ATOMIC_SEQ_CST) == 0) {
        pid_t child = fork();
        CHECK(child >= 0);
        if (child == 0) {
            alarm(HUNG);
            srbf_material *material = NULL;
            CHECK_STATUS(SRBF_STATUS_OTHER, srbf_fit_brdf(NULL, gloss, &height, &material, NULL));
            CHECK(strstr(srbf_last_message(), "forked within a fit") != NULL);
            _exit(0);
        }
        int status;
        CHECK(waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0);
    }
}

/* Of a process that has fitted, that is fitting, and whose fit forks. */
static void test_children(srbf_fit_settings settings) {
    fit_in_child();
#ifdef __SANITIZE_ADDRESS__
    /* A child that is forked while another thread allocates may hang in the sanitizer's own allocator, at its first malloc: gcc 12 gives its
     * locks to no child. One fork in about 2400 did. */
    (void)settings, (void)fit_in_thread, (void)forking;
#else
    pthread_t thread;
    CHECK(pthread_create(&thread, NULL, fit_in_thread, &settings) == 0);
    const struct timespec tenth = {0, 100000000};
    nanosleep(&tenth, NULL);
    fit_in_child();
    CHECK(pthread_join(thread, NULL) == 0);
    int has_forked = 0;
    srbf_material *material = NULL;
    settings.lobes = 1, settings.squeezed_lobes = SRBF_FIT_AUTOMATIC;
    CHECK_OK(srbf_fit_brdf(&settings, forking, &has_forked, &material, NULL));
    CHECK(has_forked);
    CHECK_OK(srbf_material_free(material));
#endif
}

/* Material and samples say where they come from, line by line. */
static void check_provenance(const srbf_material *material) {
    srbf_material_info info;
    CHECK_OK(srbf_material_query(material, &info));
    char text[1024] = {0};
    CHECK(info.provenance_length < sizeof text);
    memcpy(text, info.provenance, info.provenance_length);
    CHECK(strstr(text, "through its C interface\nsrbf-fit ") != NULL);
}

/* Numbers within the bounds of the fit, and as many lines of faults as it counts, after a sentence. */
static void check_report(const srbf_fit_report *report) {
    printf("%s", report->verdict);
    CHECK(report->error > 0 && report->worst_error >= report->error);
    CHECK_MEAN(report->error < 0.1 && report->worst_error < 0.3);
    CHECK(report->worst_error_theta >= 0 && report->worst_error_theta < 1.5707964);
    CHECK(report->luminance_error > 0);
    CHECK_MEAN(report->luminance_error < 0.1 && report->energy_error < 0.05);
    CHECK(report->largest_weight >= 1 && report->largest_weight < 30 && report->seconds > 0 && report->seconds < HUNG);
    CHECK(memchr(report->verdict, 0, sizeof report->verdict) != NULL && strstr(report->verdict, "relative L2: median") != NULL);
    CHECK_MEAN(strncmp(report->verdict, "use it", 6) == 0);
    size_t faults = 0;
    for (const char *line = report->verdict; line != NULL; line = strchr(line, '\n')) {
        line += *line == '\n';
        faults += strncmp(line, "off ", 4) == 0;
    }
    CHECK(faults == report->faults);
}

/* A file and its mode stay as they were, and so does an entry that is no file. */
static void test_places(const srbf_material *material, const char *folder) {
    char file[4096], link[4096], pipe[4096];
    CHECK(snprintf(file, sizeof file, "%s/made/file.srbf", folder) < (int)sizeof file);
    CHECK(snprintf(link, sizeof link, "%s/made/link.srbf", folder) < (int)sizeof link);
    CHECK(snprintf(pipe, sizeof pipe, "%s/made/pipe.srbf", folder) < (int)sizeof pipe);
    unlink(file), unlink(link), unlink(pipe);
    struct stat found;
    CHECK_OK(srbf_material_save(material, file));
    CHECK(chmod(file, 0640) == 0 && symlink("file.srbf", link) == 0);
    CHECK_OK(srbf_material_save(material, link));
    CHECK(lstat(link, &found) == 0 && S_ISLNK(found.st_mode));
    CHECK(lstat(file, &found) == 0 && S_ISREG(found.st_mode) && (found.st_mode & 07777) == 0640);
    CHECK(mkfifo(pipe, 0600) == 0);
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_save(material, pipe));
    CHECK(lstat(pipe, &found) == 0 && S_ISFIFO(found.st_mode));
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_save(material, folder));
    CHECK(strstr(srbf_last_message(), "this is a folder") != NULL);
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_save(material, "/dev/null"));
    CHECK(strstr(srbf_last_message(), "/dev/null: a regular file is expected") != NULL);
    CHECK(stat("/dev/null", &found) == 0 && S_ISCHR(found.st_mode));
    unlink(file), unlink(link), unlink(pipe);
}

int main(int count, char **arguments) {
    CHECK(count == 2);
    test_without_threads();
    float height = 0.5f;
    srbf_fit_settings settings;
    srbf_material *material = NULL, *again = NULL;
    CHECK_OK(srbf_fit_settings_default(&settings));
    CHECK(settings.lobes == 12 && settings.squeezed_lobes == SRBF_FIT_AUTOMATIC);
    CHECK(fabs(settings.smoothness / 5e-5 - 1) < 1e-12);
    CHECK(settings.mirrored_pairs == SRBF_FIT_AUTOMATIC && settings.views == SRBF_FIT_AUTOMATIC);
    CHECK(settings.factor_nodes[2] == SRBF_FIT_AUTOMATIC && settings.error == 0);
    settings = quick();

    enum { VIEWS = 6, N = VIEWS * SAMPLES };
    static float wo[N][3], wi[N][3], f[N][3];
    uint64_t state = 9;
    for (int i = 0; i < N; i++) {
        float theta = 0.25f * (float)(i / SAMPLES), phi = 6.2831853f * uniform(&state);
        wo[i][0] = sinf(theta) * cosf(phi), wo[i][1] = sinf(theta) * sinf(phi), wo[i][2] = cosf(theta);
        direction(&state, wi[i]);
        gloss(&height, wi[i], wo[i], f[i]);
    }
    srbf_vectors o = {wo[0], wo[0] + 1, wo[0] + 2, 12}, in = {wi[0], wi[0] + 1, wi[0] + 2, 12};
    srbf_vectors values = {f[0], f[0] + 1, f[0] + 2, 12};
    srbf_fit_report report;
    CHECK_OK(srbf_fit_table(&settings, N, &o, &in, &values, &material, &report));
    check_report(&report);
    check_fit(material, height, 0.1f);
    check_provenance(material);
    char path[4096];
    CHECK(snprintf(path, sizeof path, "%s/made/by/fit/fit.srbf", arguments[1]) < (int)sizeof path);
    CHECK_OK(srbf_material_save(material, path));
    CHECK_OK(srbf_material_load(path, &again));
    srbf_material_info a, b;
    CHECK_OK(srbf_material_query(material, &a));
    CHECK_OK(srbf_material_query(again, &b));
    CHECK(a.byte_count == b.byte_count && memcmp(a.bytes, b.bytes, a.byte_count) == 0 && a.lobes == 6);
    CHECK_OK(srbf_material_free(material));
    settings.factor_nodes[0] = 8, settings.factor_nodes[1] = 4, settings.factor_nodes[2] = 2;
    CHECK_OK(srbf_fit_brdf(&settings, gloss, &height, &material, &report));
    check_report(&report);
    check_fit(material, height, 0.1f);
    CHECK_OK(srbf_material_query(material, &a));
    CHECK(a.views == FITTED_VIEWS && a.lobes == 6 && a.has_signed_factors == 0);
    CHECK_OK(srbf_material_free(material));
    /* The same fit by the same code, but for signs. */
#ifndef SHORT
    settings.factor_nodes[2] = 3, settings.has_signed_factors = 1;
    CHECK_OK(srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    check_fit(material, height, 0.1f);
    CHECK_OK(srbf_material_query(material, &a));
    CHECK(a.factor_nodes[2] == 3 && a.has_signed_factors == 1);
    CHECK_OK(srbf_material_free(material));
#endif
    settings = quick(), settings.error = 0.2;
    CHECK_OK(srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    CHECK_OK(srbf_material_query(material, &a));
    CHECK(a.lobes < 6);
    CHECK_OK(srbf_material_free(material));
    settings = quick();
    test_children(settings);

    /* Refusals. */
    material = NULL;
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_fit_settings_default(NULL));
    CHECK(strncmp(srbf_last_message(), "settings: ", 10) == 0);
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_fit_brdf(&settings, NULL, NULL, &material, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_fit_brdf(&settings, gloss, &height, NULL, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_fit_table(&settings, N, NULL, &in, &values, &material, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_fit_table(&settings, N, &o, &in, &values, NULL, NULL));
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_fit_brdf(&settings, gloss, &height, &material, (srbf_fit_report *)&material));
    CHECK(strncmp(srbf_last_message(), "report: ", 8) == 0);
    CHECK_STATUS(SRBF_STATUS_TABLE, srbf_fit_table(&settings, 0, &o, &in, &values, &material, NULL));
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_fit_table(&settings, SIZE_MAX / 4, &o, &in, &values, &material, NULL));
    const float good_wo[3] = {0, 0, 1}, bad[][3] = {{NAN, 0, 1}, {0, 0, 0}, {INFINITY, 0, 0}, {0, 0, 0.5f}};
    float good_wi[3];
    memcpy(good_wi, wi[7], sizeof good_wi);
    for (int i = 0; i < 4; i++) {
        memcpy(wo[7], bad[i], sizeof bad[i]);
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_fit_table(&settings, N, &o, &in, &values, &material, NULL));
        CHECK(strstr(srbf_last_message(), "sample 7") != NULL);
        memcpy(wo[7], good_wo, sizeof good_wo);
        memcpy(wi[7], bad[i], sizeof bad[i]);
        CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_fit_table(&settings, N, &o, &in, &values, &material, NULL));
        memcpy(wi[7], good_wi, sizeof good_wi);
    }
    f[7][1] = NAN;
    CHECK_STATUS(SRBF_STATUS_TABLE, srbf_fit_table(&settings, N, &o, &in, &values, &material, NULL));
    f[7][1] = 0.1f, wo[7][2] = -1;
    CHECK_STATUS(SRBF_STATUS_TABLE, srbf_fit_table(&settings, N, &o, &in, &values, &material, NULL));
    CHECK(strstr(srbf_last_message(), "no material can be fitted to the table: view at") != NULL);
    settings.lobes = 0;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    settings.lobes = 6, settings.squeezed_lobes = 7;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    settings.squeezed_lobes = 2, settings.smoothness = (double)NAN;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    settings = quick(), settings.views = 1;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    settings = quick(), settings.starts = 0;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    settings = quick(), settings.factor_nodes[0] = 1000000;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    settings = quick(), settings.error = -1;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_fit_brdf(&settings, gloss, &height, &material, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_save(NULL, path));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_save(again, NULL));
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_save(again, "/dev/null/a.srbf"));
    CHECK(strstr(srbf_last_message(), "/dev/null/a.srbf: ") != NULL);
    CHECK_STATUS(SRBF_STATUS_FILE, srbf_material_save(again, ""));
    CHECK_STATUS(SRBF_STATUS_TEXT, srbf_material_save(again, "\xff"));
    CHECK(material == NULL);
    test_places(again, arguments[1]);
    CHECK_OK(srbf_material_free(again));
    printf("fit: passed\n");
    return 0;
}
