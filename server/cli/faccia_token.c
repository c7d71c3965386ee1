/* SPDX-License-Identifier: GPL-3.0-or-later */
/* faccia token: signs tokens, which grant a page or a person permissions. */
#include "server/access/page_link.h"
#include "server/access/token.h"
#include "server/base/options.h"
#include "server/cli/cli.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char usage[] =
    "Usage: faccia token --secret-file FILE --subject NAME [OPTION]...\n"
    "       faccia token --secret-file FILE --revoke TOKEN\n"
    "       faccia token --revoke-subject NAME [--expires TIME]\n"
    "Prints a token for a daemon started with --secret-file FILE; or the line that\n"
    "revokes one token, or all of a subject: add it to the daemon's --revoked-file.\n"
    "\n"
    "      --secret-file FILE   a secret of at least 32 bytes on each line; the first one signs.\n"
    "                           To create one: head -c 32 /dev/urandom | base64\n"
    "  -s, --subject NAME       the token's holder; up to 64 bytes\n"
    "      --room NAME          valid only in this room\n"
    "      --rights WORDS       listen, speak, operate, separated by commas (listen,speak)\n"
    "      --expires TIME       period of validity: 90s, 15m, 12h, 30d (15m)\n"
    "      --page ADDRESS       print the address of this page with the token in it, and its QR\n"
    "                           code on a terminal: http://192.168.1.20:8080/room.html?room=kitchen\n"
    "      --revoke TOKEN       revoke this token\n"
    "      --revoke-subject NAME  revoke all tokens issued so far for NAME; --expires is the\n"
    "                           longest period of validity among them\n"
    "  -h, --help               print this and exit\n"
    "Exit status: 0 printed, 1 failed, 2 wrong usage.\n";

static int complain(const struct error *e) {
    char text[400];
    cli_complain("%s", error_text(e, text, sizeof text));
    return EXIT_USAGE;
}

/* Converts "15m" to seconds; -1 if it is not a duration. */
static long seconds_of(const char *text) {
    static const struct {
        char unit;
        long seconds;
    } units[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}};
    char *end;
    long number = strtol(text, &end, 10);
    if (end == text || number < 1 || number > 36500 * 24L * 3600)
        return -1;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (end[0] == units[i].unit && !end[1] && number <= 36500 * 86400L / units[i].seconds)
            return number * units[i].seconds;
    return -1;
}

static int copy(char *out, size_t cap, const char *value, const char *option) {
    if (!*value || strlen(value) >= cap) {
        cli_complain("--%s: must have 1 to %zu bytes", option, cap - 1);
        return -1;
    }
    memcpy(out, value, strlen(value) + 1);
    return 0;
}

/* Prints a page's address with the token, and its QR code below if a person sees it. */
static int print_page(const char *page, const char *token) {
    struct buf link = {0};
    struct error e;
    if (page_link_write(page, token, &link, &e))
        return complain(&e);
    const char *text = (const char *)link.data;
    puts(text);
    if (isatty(STDOUT_FILENO) && page_link_draw(text, stdout))
        cli_complain("the address is too long for a QR code");
    buf_free(&link);
    return EXIT_DONE;
}

static int print(const char *secret_file, const struct token *token, const char *page) {
    struct secrets secrets;
    struct error e;
    if (secrets_load(&secrets, secret_file, &e)) {
        complain(&e);
        return EXIT_FAILED;
    }
    char *text = token_make(&secrets, token, &e);
    secrets_free(&secrets);
    if (!text) {
        complain(&e);
        return EXIT_FAILED;
    }
    int result = EXIT_DONE;
    if (page)
        result = print_page(page, text);
    else
        puts(text);
    free(text);
    return result;
}

static int print_revoked(const char *secret_file, const char *text) {
    struct secrets secrets;
    struct token token;
    struct error e;
    char *jti = NULL;
    int result = EXIT_FAILED;
    if (secrets_load(&secrets, secret_file, &e)) {
        complain(&e);
        return EXIT_FAILED;
    }
    if (token_check(&secrets, text, (long)time(NULL), &token, &e)) {
        complain(&e);
    } else if (!(jti = token_id(text))) {
        cli_complain("the token has no 'jti': use --revoke-subject to revoke all tokens of '%s'",
                     token.subject);
    } else {
        printf("token %ld %s\n", token.expires, jti);
        result = EXIT_DONE;
    }
    secrets_free(&secrets);
    free(jti);
    return result;
}

int token_main(int argc, char **argv, const struct settings *settings) {
    (void)settings;
    enum { SECRET = 256, ROOM, RIGHTS, EXPIRES, PAGE, REVOKE, REVOKE_SUBJECT };
    static const struct option options[] = {
        {"secret-file", 1, NULL, SECRET}, {"subject", 1, NULL, 's'},
        {"room", 1, NULL, ROOM},          {"rights", 1, NULL, RIGHTS},
        {"expires", 1, NULL, EXPIRES},    {"page", 1, NULL, PAGE},
        {"revoke", 1, NULL, REVOKE},      {"revoke-subject", 1, NULL, REVOKE_SUBJECT},
        {"help", 0, NULL, 'h'},           {0}};
    struct token token = {.rights = RIGHT_LISTEN | RIGHT_SPEAK};
    struct error e;
    const char *secret_file = NULL, *page = NULL, *revoke = NULL, *revoke_subject = NULL;
    long seconds = 15 * 60;
    for (int c; (c = options_next(argc, argv, "s:h", options, NULL)) != -1;) {
        switch (c) {
        case SECRET:
            secret_file = optarg;
            break;
        case 's':
            if (copy(token.subject, sizeof token.subject, optarg, "subject"))
                return EXIT_USAGE;
            break;
        case ROOM:
            if (copy(token.room, sizeof token.room, optarg, "room"))
                return EXIT_USAGE;
            break;
        case RIGHTS:
            if (rights_parse(optarg, &token.rights, &e))
                return complain(&e);
            break;
        case EXPIRES:
            if ((seconds = seconds_of(optarg)) < 0) {
                cli_complain("--expires: '%s' is not a period such as 90s, 15m, 12h, 30d", optarg);
                return EXIT_USAGE;
            }
            break;
        case PAGE:
            page = optarg;
            break;
        case REVOKE:
            revoke = optarg;
            break;
        case REVOKE_SUBJECT:
            revoke_subject = optarg;
            break;
        case 'h':
            fputs(usage, stdout);
            return EXIT_DONE;
        default:
            fputs("Try 'faccia token --help'.\n", stderr);
            return EXIT_USAGE;
        }
    }
    bool makes = *token.subject != '\0';
    if (makes + (revoke != NULL) + (revoke_subject != NULL) != 1 || (!secret_file && !revoke_subject) ||
        (page && !makes) || optind < argc) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    if (revoke)
        return print_revoked(secret_file, revoke);
    token.issued = (long)time(NULL);
    token.expires = token.issued + seconds;
    if (revoke_subject) {
        printf("subject %ld %ld %s\n", token.issued, token.expires, revoke_subject);
        return EXIT_DONE;
    }
    return print(secret_file, &token, page);
}
