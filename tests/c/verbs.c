/* The grid of verbs: whatever the shape of a call, it gives the results of the call for one direction. */
#include "check.h"

enum { N = 67, ROWS = 1024 };

typedef struct {
    const srbf_material *material;
    float wo[3], wi[3], u[3], value[3], pdf;
    srbf_sample sample;
} hit;

static hit hits[N];

static srbf_vectors in(const float *first) {
    srbf_vectors vectors = {first, first + 1, first + 2, sizeof(hit)};
    return vectors;
}

static srbf_vectors_out out(float *first) {
    srbf_vectors_out vectors = {first, first + 1, first + 2, sizeof(hit)};
    return vectors;
}

/* Forgets every output. */
static void clear(void) {
    for (int i = 0; i < N; i++) {
        memset(hits[i].value, 0xff, sizeof hits[i].value);
        memset(&hits[i].sample, 0xff, sizeof hits[i].sample);
        hits[i].pdf = NAN;
    }
}

enum { VALUE = 1, PDF = 2, SAMPLE = 4, WEIGHT = 8 };

/* Compares the written results with calls for one direction, of mixtures `stride` bytes apart, or of one. */
static void compare(const unsigned char *mixtures, size_t stride, int what, float tolerance) {
    for (size_t i = 0; i < N; i++) {
        const srbf_mixture *mixture = (const srbf_mixture *)(const void *)(mixtures + i * stride);
        hit *h = &hits[i];
        float value[3], pdf, largest;
        srbf_sample sample;
        CHECK_OK(srbf_mixture_sample_and_evaluate(mixture, h->u, &sample, h->wi, value, &pdf));
        largest = fmaxf(fmaxf(value[0], value[1]), value[2]);
        for (int c = 0; c < 3; c++) {
            CHECK(!(what & VALUE) || fabsf(h->value[c] - value[c]) <= tolerance * largest);
            CHECK(!(what & SAMPLE) || fabsf(h->sample.direction[c] - sample.direction[c]) <= 3e-3f);
            CHECK(!(what & WEIGHT) || fabsf(h->sample.weight[c] - sample.weight[c]) <= 20 * tolerance * (1 + sample.weight[c]));
        }
        CHECK(!(what & PDF) || fabsf(h->pdf - pdf) <= tolerance * pdf);
        if (what & SAMPLE) {
            /* At the direction itself. */
            CHECK_OK(srbf_mixture_pdf(mixture, h->sample.direction, &pdf));
            CHECK(fabsf(h->sample.pdf - pdf) <= 20 * tolerance * pdf);
        }
    }
    clear();
}

static void test_refused(const srbf_material *material, const srbf_mixture *mixture) {
    srbf_vectors wo = in(hits->wo), wi = in(hits->wi), u = in(hits->u);
    srbf_vectors_out value = out(hits->value);
    srbf_numbers_out pdf = {&hits->pdf, sizeof(hit)};
    srbf_samples_out samples = {out(hits->sample.direction), {&hits->sample.pdf, sizeof(hit)}, out(hits->sample.weight)};
    const size_t stride = SRBF_MIXTURE_SIZE_64;
    float one[3] = {2, 0, 0};
    srbf_sample sample;

    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_and_evaluate(mixture, hits->u, NULL, hits->wi, one, one));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_mixture_sample_and_evaluate(mixture, hits->u, &sample, one, hits->value, one));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_mixture_sample_and_evaluate(mixture, one, &sample, hits->wi, hits->value, one));

    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_ask(NULL, 0, N, ASK(.wi = wi, .value = value)));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_ask(mixture, 0, N, ASK(.value = value)));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_ask(mixture, stride, N, ASK(.samples = samples)));
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_ask(mixture, stride, N, ASK(.u = u, .samples.pdf = pdf)));
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_mixture_ask(mixture, SRBF_MIXTURE_SIZE_16 / 2, N, ASK(.u = u, .samples = samples)));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_ask(material, N, ASK(.wi = wi, .value = value)));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_ask(material, N, ASK(.wo = wo, .samples = samples)));
    /* A request for nothing. */
    CHECK_OK(srbf_mixture_ask(mixture, 0, N, ASK(.wi = wi)));
    CHECK_OK(srbf_mixture_ask(mixture, stride, N, ASK(.u = u)));
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo)));
    /* Two outputs in one place. */
    srbf_numbers_out upon = {&hits->value[1], sizeof(hit)};
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_mixture_ask(mixture, 0, N, ASK(.wi = wi, .value = value, .pdf = upon)));
    CHECK_STATUS(SRBF_STATUS_OVERLAP,
                 srbf_material_ask(material, N, ASK(.wo = wo, .u = u, .samples = samples, .wi = wi, .value = value, .pdf = upon)));
    CHECK_STATUS(SRBF_STATUS_OVERLAP,
                 srbf_mixture_ask(mixture, stride, N, ASK(.u = u, .samples = samples, .wi = wi, .value = value, .pdf = upon)));
    /* For no hits no pointer is looked at. */
    CHECK_OK(srbf_mixture_ask(NULL, 0, 0, NULL));
    CHECK_OK(srbf_mixture_ask(NULL, 16, 0, NULL));
    CHECK_OK(srbf_material_ask(NULL, 0, NULL));
    clear();
}

/* The verbs of a material for one hit, by the same comparison. */
static void test_hits(const srbf_material *material, const unsigned char *mixtures, size_t stride) {
    const float exact = 2e-5f, down[3] = {0.6f, 0, -0.8f}, up[3] = {0, 0, 1}, none[3] = {2, 0, 0};
    for (int i = 0; i < N; i++) {
        hit *h = &hits[i];
        float value[3], pdf;
        srbf_sample sample;
        CHECK_OK(srbf_material_sample_and_evaluate(material, h->wo, h->u, &h->sample, h->wi, h->value, &h->pdf));
        CHECK_OK(srbf_material_sample(material, h->wo, h->u, &sample));
        CHECK(memcmp(&sample, &h->sample, sizeof sample) == 0);
        CHECK_OK(srbf_material_evaluate_and_pdf(material, h->wo, h->wi, value, &pdf));
        CHECK(memcmp(value, h->value, sizeof value) == 0 && pdf == h->pdf);
        CHECK_OK(srbf_material_evaluate(material, h->wo, h->wi, value));
        CHECK(memcmp(value, h->value, sizeof value) == 0);
        CHECK_OK(srbf_material_pdf(material, h->wo, h->wi, &pdf));
        CHECK(pdf == h->pdf);
    }
    compare(mixtures, stride, VALUE | PDF | SAMPLE | WEIGHT, exact);

    float value[3], pdf;
    srbf_sample sample;
    CHECK_OK(srbf_material_sample_and_evaluate(material, down, hits->u, &sample, up, value, &pdf));
    CHECK(sample.pdf == 0 && sample.direction[2] == 1 && sample.weight[1] == 0 && value[1] == 0 && pdf == 0);
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_evaluate(NULL, up, up, value));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_pdf(material, up, NULL, &pdf));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_evaluate_and_pdf(material, up, up, value, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_sample(material, up, hits->u, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_sample_and_evaluate(material, up, NULL, &sample, up, value, &pdf));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_evaluate(material, none, up, value));
    CHECK_STATUS(SRBF_STATUS_DIRECTION, srbf_material_pdf(material, up, none, &pdf));
    CHECK_STATUS(SRBF_STATUS_UNIFORM, srbf_material_sample(material, up, up, &sample));
}

/* Requests of a material, or of those of the hits. */
static void test_request(const srbf_material *material, srbf_materials materials, const unsigned char *mixtures, size_t stride) {
    const float exact = 2e-5f;
    srbf_request all = {0}, request;
    all.size = sizeof all, all.materials = materials;
    all.wo = in(hits->wo), all.wi = in(hits->wi), all.u = in(hits->u);
    all.value = out(hits->value), all.pdf.values = &hits->pdf, all.pdf.stride = sizeof(hit);
    all.samples.direction = out(hits->sample.direction), all.samples.weight = out(hits->sample.weight);
    all.samples.pdf.values = &hits->sample.pdf, all.samples.pdf.stride = sizeof(hit);
    CHECK_OK(srbf_material_ask(material, N, &all));
    compare(mixtures, stride, VALUE | PDF | SAMPLE | WEIGHT, exact);
    request = all, request.samples.direction.x = NULL, request.samples.weight.x = NULL, request.samples.pdf.values = NULL;
    request.u.x = NULL;
    CHECK_OK(srbf_material_ask(material, N, &request));
    CHECK(isnan(hits[3].sample.pdf) && isnan(hits[3].sample.direction[0]));
    compare(mixtures, stride, VALUE | PDF, exact);
    request.value.x = NULL;
    CHECK_OK(srbf_material_ask(material, N, &request));
    CHECK(isnan(hits[3].value[0]));
    compare(mixtures, stride, PDF, exact);
    request = all, request.value.x = NULL, request.pdf.values = NULL, request.samples.weight.x = NULL, request.wi.x = NULL;
    CHECK_OK(srbf_material_ask(material, N, &request));
    CHECK(isnan(hits[3].pdf) && isnan(hits[3].sample.weight[0]));
    compare(mixtures, stride, SAMPLE, exact);

    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_ask(material, N, NULL));
    request = all, request.size = 8;
    CHECK_STATUS(SRBF_STATUS_SIZE, srbf_material_ask(material, N, &request));
    CHECK(strncmp(srbf_last_message(), "request->size: ", 15) == 0);
    request = all, request.wi.y = NULL;
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_ask(material, N, &request));
    CHECK(strncmp(srbf_last_message(), "request->wi: ", 13) == 0);
    request = all, request.value.stride = 2;
    CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_material_ask(material, N, &request));
    CHECK(strncmp(srbf_last_message(), "request->value: ", 16) == 0);
    request = all, request.samples.direction.x = NULL;
    CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_material_ask(material, N, &request));
    request = all, request.pdf.values = &hits->value[1];
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(material, N, &request));
    /* Upon an input, and upon a material. */
    request = all, request.pdf.values = &hits->wo[1];
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(material, N, &request));
    request.pdf.values = (float *)(void *)(size_t)(material != NULL ? material : hits->material);
    CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(material, N, &request));
    /* Upon the pointers to the materials. */
    request.pdf.values = (float *)(void *)(size_t)&hits->material;
    if (material == NULL) {
        CHECK_STATUS(SRBF_STATUS_OVERLAP, srbf_material_ask(NULL, N, &request));
        request = all, request.materials.first = NULL;
        CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_ask(NULL, N, &request));
        request = all, request.materials.stride = 4;
        CHECK_STATUS(SRBF_STATUS_STRIDE, srbf_material_ask(NULL, N, &request));
        hits[9].material = (const srbf_material *)(const void *)mixtures;
        CHECK_STATUS(SRBF_STATUS_OBJECT, srbf_material_ask(NULL, N, &all));
        hits[9].material = NULL;
        CHECK_STATUS(SRBF_STATUS_NULL, srbf_material_ask(NULL, N, &all));
        hits[9].material = hits->material;
    }
    clear();
}

/* One direction in `share` is of the cosine, and the density says so. */
static void test_defensive(const srbf_mixture *mixture) {
    const float share = 0.25f, shares[] = {-0.1f, 1.1f, NAN};
    float pdf, whole;
    double mean = 0;
    srbf_sample sample;
    for (int i = 0; i < N; i++) {
        const float cosine = fmaxf(hits[i].wi[2], 0);
        CHECK_OK(srbf_mixture_pdf(mixture, hits[i].wi, &pdf));
        CHECK_OK(srbf_mixture_pdf_defensive(mixture, share, hits[i].wi, &whole));
        CHECK(fabsf(whole - ((1 - share) * pdf + share * cosine / 3.14159265f)) <= 1e-5f * whole);
        CHECK_OK(srbf_mixture_sample_defensive(mixture, share, hits[i].u, &sample));
        CHECK_OK(srbf_mixture_pdf_defensive(mixture, share, sample.direction, &whole));
        CHECK(fabsf(sample.pdf - whole) <= 1e-4f * whole && sample.pdf >= share * sample.direction[2] / 3.1416f);
        mean += (double)sample.weight[1] / N;
    }
    CHECK(mean > 0 && mean < 2);
    for (int i = 0; i < 3; i++) {
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_sample_defensive(mixture, shares[i], hits->u, &sample));
        CHECK_STATUS(SRBF_STATUS_ARGUMENT, srbf_mixture_pdf_defensive(mixture, shares[i], hits->wi, &pdf));
    }
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_sample_defensive(mixture, share, hits->u, NULL));
    CHECK_STATUS(SRBF_STATUS_NULL, srbf_mixture_pdf_defensive(NULL, share, hits->wi, &pdf));
}

int main(int argc, char **argv) {
    CHECK(argc == 2);
    srbf_material *material;
    CHECK_OK(srbf_material_load(argv[1], &material));
    uint64_t state = 17;
    for (int i = 0; i < N; i++) {
        direction(&state, hits[i].wo), direction(&state, hits[i].wi);
        hits[i].wo[2] = fabsf(hits[i].wo[2]);
        for (int c = 0; c < 3; c++) hits[i].u[c] = uniform(&state);
    }
    const srbf_vectors wo = in(hits->wo), wi = in(hits->wi), u = in(hits->u);
    const srbf_vectors_out value = out(hits->value);
    const srbf_numbers_out pdf = {&hits->pdf, sizeof(hit)}, density = {&hits->sample.pdf, sizeof(hit)};
    const srbf_samples_out samples = {out(hits->sample.direction), density, out(hits->sample.weight)};

    /* n mixtures, some with more room than others. */
    const size_t stride = SRBF_MIXTURE_SIZE_64;
    unsigned char *storage = (unsigned char *)aligned_alloc(64, (N * stride + 63) / 64 * 64);
    CHECK(storage != NULL);
    for (size_t i = 0; i < N; i++) {
        const size_t sizes[3] = {SRBF_MIXTURE_SIZE_16, SRBF_MIXTURE_SIZE_32, SRBF_MIXTURE_SIZE_64};
        srbf_mixture *mixture;
        CHECK_OK(srbf_mixture_init(storage + i * stride, i < 20 ? sizes[0] : sizes[i % 7 % 3], &mixture));
        CHECK_OK(srbf_material_prepare(material, hits[i].wo, mixture));
    }
    const srbf_mixture *mixtures = (const srbf_mixture *)(const void *)storage;
    test_refused(material, mixtures);
    test_defensive(mixtures);
    const float exact = 2e-5f;
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.wi = wi, .value = value)));
    compare(storage, stride, VALUE, exact);
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.wi = wi, .value = value, .pdf = pdf)));
    compare(storage, stride, VALUE | PDF, exact);
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.wi = wi, .pdf = pdf)));
    compare(storage, stride, PDF, exact);
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.u = u, .samples = samples)));
    compare(storage, stride, SAMPLE | WEIGHT, exact);
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.u = u, .samples.direction = samples.direction, .samples.pdf = density)));
    compare(storage, stride, SAMPLE, exact);
    CHECK_OK(srbf_mixture_ask(mixtures, stride, N, ASK(.u = u, .samples = samples, .wi = wi, .value = value, .pdf = pdf)));
    compare(storage, stride, VALUE | PDF | SAMPLE | WEIGHT, exact);

    /* n directions of one. */
    CHECK_OK(srbf_mixture_ask(mixtures, 0, N, ASK(.wi = wi, .value = value, .pdf = pdf)));
    compare(storage, 0, VALUE | PDF, exact);
    CHECK_OK(srbf_mixture_ask(mixtures, 0, N, ASK(.u = u, .samples = samples, .wi = wi, .value = value, .pdf = pdf)));
    compare(storage, 0, VALUE | PDF | SAMPLE | WEIGHT, exact);

    /* A material, hit by hit, and n outgoing directions of it. */
    test_hits(material, storage, stride);
    for (int i = 0; i < N; i++) hits[i].material = material;
    const srbf_materials none = {NULL, 0}, each = {&hits->material, sizeof(hit)};
    test_request(material, none, storage, stride);
    test_request(NULL, each, storage, stride);
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo, .wi = wi, .value = value)));
    compare(storage, stride, VALUE, exact);
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo, .wi = wi, .value = value, .pdf = pdf)));
    compare(storage, stride, VALUE | PDF, exact);
    CHECK_OK(srbf_material_ask(material, N, ASK(.wo = wo, .u = u, .samples = samples, .wi = wi, .value = value, .pdf = pdf)));
    compare(storage, stride, VALUE | PDF | SAMPLE | WEIGHT, exact);

    /* And of an expanded one, whose mixtures are near those of the material. */
    size_t size;
    srbf_expanded *expanded;
    CHECK_OK(srbf_expanded_size(material, ROWS, &size));
    void *rows = malloc(size);
    CHECK(rows != NULL);
    CHECK_OK(srbf_expanded_make(material, ROWS, rows, size, &expanded));
    for (size_t i = 0; i < N; i++) {
        CHECK_OK(srbf_expanded_prepare(expanded, hits[i].wo, (srbf_mixture *)(void *)(storage + i * stride)));
    }
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = wo, .u = u, .samples.direction = samples.direction, .samples.pdf = density)));
    compare(storage, stride, SAMPLE, exact);
    CHECK_OK(srbf_expanded_ask(expanded, N, ASK(.wo = wo, .u = u, .samples = samples, .wi = wi, .value = value, .pdf = pdf)));
    compare(storage, stride, VALUE | PDF | SAMPLE | WEIGHT, exact);

    free(rows), free(storage);
    CHECK_OK(srbf_material_free(material));
    puts("verbs: passed");
    return 0;
}
