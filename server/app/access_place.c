/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/access_place.h"
#include "server/app/settings.h"
#include <time.h>

int access_place_load(struct access_place *place, const struct settings *settings, struct error *e) {
    *place = (struct access_place){0};
    if ((!settings->secret_file || !secrets_load(&place->secrets, settings->secret_file, e)) &&
        (!settings->revoked_file ||
         !revocations_load(&place->revocations, settings->revoked_file, (long)time(NULL), e)))
        return 0;
    access_place_free(place);
    return -1;
}

void access_place_free(struct access_place *place) {
    secrets_free(&place->secrets);
    revocations_free(&place->revocations);
}
