/* ISA-L's deflate behind plain arguments, and the same without ISA-L: then nothing is packed. */
#ifdef TESSERA_ISAL
#include <isa-l/igzip_lib.h>
#include <limits.h>
#include <stdlib.h>

/* Packs bytes into a zlib stream; its length, 0 if that fails or there is no room. */
long tessera_isal_deflate(const void *in, long n_in, void *out, long n_out)
{
    long n = 0;
    struct isal_zstream *stream = malloc(sizeof *stream);
    void *level_buffer = malloc(ISAL_DEF_LVL1_DEFAULT);

    if (stream != NULL && level_buffer != NULL && n_in <= INT_MAX && n_out <= INT_MAX) {
        isal_deflate_stateless_init(stream);
        stream->level = 1;
        stream->level_buf = level_buffer;
        stream->level_buf_size = ISAL_DEF_LVL1_DEFAULT;
        stream->gzip_flag = IGZIP_ZLIB;
        stream->next_in = (uint8_t *)in;
        stream->avail_in = (uint32_t)n_in;
        stream->next_out = out;
        stream->avail_out = (uint32_t)n_out;
        if (isal_deflate_stateless(stream) == COMP_OK)
            n = (long)stream->total_out;
    }
    free(level_buffer);
    free(stream);
    return n;
}

#else

long tessera_isal_deflate(const void *in, long n_in, void *out, long n_out)
{
    (void)in, (void)n_in, (void)out, (void)n_out;
    return 0;
}

#endif
