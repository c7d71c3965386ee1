/* SPDX-License-Identifier: GPL-3.0-or-later */
/* All errors and warnings: identifier, stable code (explained in protocol/README.md), HTTP status (0:
 * never sent as a response; would be 500) and default message. tests/protocol/errors.test.mjs checks that
 * this table, the protocol's text and the schemas agree. */
#ifndef FACCIA_BASE_ERROR_CODES_H
#define FACCIA_BASE_ERROR_CODES_H

/* clang-format off */
#define ERROR_CODES(X) \
    /* messages and requests */ \
    X(BAD_JSON, "bad-json", 400, "this is not JSON") \
    X(BAD_MESSAGE, "bad-message", 400, "a message must be an object with a string 'type'") \
    X(UNKNOWN_TYPE, "unknown-type", 400, "there is no such type of message") \
    X(MISSING_FIELD, "missing-field", 400, "is missing") \
    X(BAD_FIELD, "bad-field", 400, "has the wrong type, or is out of range") \
    X(UNKNOWN_MEMBER, "unknown-member", 0, "there is no such member") \
    X(BINARY_MESSAGE, "binary-message", 400, "binary messages are not accepted") \
    X(UNKNOWN_COMMAND, "unknown-command", 400, "there is no such command") \
    X(MESSAGE_TOO_LONG, "message-too-long", 413, "the message is too long") \
    X(TEXT_TOO_LONG, "text-too-long", 413, "the text is too long") \
    /* unknown or unavailable resources */ \
    X(UNKNOWN_LANGUAGE, "unknown-language", 400, "there is no such language") \
    X(UNKNOWN_VOICE, "unknown-voice", 400, "there is no such voice") \
    X(UNKNOWN_ENGINE, "unknown-engine", 400, "there is no such engine") \
    X(UNKNOWN_MODEL, "unknown-model", 404, "there is no such head") \
    X(UNKNOWN_FORMAT, "unknown-format", 400, "there is no such format") \
    X(UNKNOWN_MARKUP, "unknown-markup", 400, "there is no such markup") \
    X(UNKNOWN_EXPRESSION, "unknown-expression", 400, "there is no such expression") \
    X(UNKNOWN_WORK, "unknown-work", 404, "there is no such work") \
    X(UNKNOWN_SECTION, "unknown-section", 404, "there is no such section") \
    X(UNKNOWN_PASSAGE, "unknown-passage", 404, "there is no such passage") \
    X(BAD_QUERY, "bad-query", 400, "this cannot be searched for") \
    X(SEARCH_TOO_LONG, "search-too-long", 503, "the search takes too long: ask for rarer words, or more of them") \
    X(TOO_MANY_SEARCHES, "too-many-searches", 503, "too many searches are queued") \
    X(UNKNOWN_CODEC, "unknown-codec", 400, "there is no such codec") \
    X(UNKNOWN_MEDIA, "unknown-media", 404, "there is no such recording") \
    X(UNKNOWN_SCENE, "unknown-scene", 404, "there is no such scene") \
    X(NOTHING_KEPT, "nothing-kept", 404, "this server has no folder to save that in") \
    X(CHANGED, "changed", 412, "it has been changed since") \
    X(CONDITION_NEEDED, "condition-needed", 428, "it already exists: name the version that you replace (If-Match)") \
    X(CANNOT_KEEP, "cannot-keep", 500, "it cannot be saved") \
    X(UNKNOWN_ROOM, "unknown-room", 404, "there is nobody in that room") \
    X(UNKNOWN_MARK, "unknown-mark", 400, "there is no such mark") \
    X(UNKNOWN_UTTERANCE, "unknown-utterance", 404, "there is no such utterance") \
    X(NOT_SPEAKING, "not-speaking", 400, "nothing is being spoken") \
    X(NO_CHOICES, "no-choices", 400, "there is no such choice, or no longer") \
    X(BUSY, "busy", 409, "something is being spoken or is queued") \
    X(DRIVEN, "driven", 409, "another client drives this face") \
    X(ROOM_AWAY, "room-away", 503, "the daemon that leads the room cannot be reached") \
    X(UNHEARD, "unheard", 0, "no listener joined to hear it") \
    /* limits */ \
    X(QUEUE_FULL, "queue-full", 503, "too many utterances are queued") \
    X(TOO_MANY_OPEN, "too-many-open", 503, "too many texts are being written") \
    X(TOO_MANY_VOICES, "too-many-voices", 503, "too many live voices are open") \
    X(TOO_MANY_ROOMS, "too-many-rooms", 503, "there are too many rooms") \
    X(TOO_MANY_REQUESTS, "too-many-requests", 429, "too many requests in this minute") \
    X(TOO_MANY_PER_ADDRESS, "too-many-per-address", 429, "too many connections from this address are open") \
    X(TOO_MANY_CONNECTIONS, "too-many-connections", 503, "too many connections are open") \
    X(MEDIA_TOO_LARGE, "media-too-large", 413, "the recording is larger than this server takes") \
    X(DOCUMENT_TOO_LONG, "document-too-long", 413, "the document is too long") \
    X(STORE_FULL, "store-full", 507, "the document limit is reached") \
    X(SKIPPED, "skipped", 0, "media were dropped for a client that is too slow") \
    X(TOO_SLOW, "too-slow", 0, "the client does not read its media") \
    X(STOPPING, "stopping", 503, "the server is shutting down") \
    /* texts and their markup */ \
    X(BAD_UTF8, "bad-utf8", 400, "the text is not UTF-8") \
    X(NUL, "nul", 400, "the text contains a NUL character") \
    X(UNFINISHED, "unfinished", 0, "the text was not closed by its writer") \
    X(EMPTY_TEXT, "empty-text", 400, "there is nothing to speak") \
    X(BAD_XML, "bad-xml", 400, "this is not well-formed XML") \
    X(TOO_DEEP, "too-deep", 400, "elements are nested too deeply") \
    X(TOO_MANY_ATTRIBUTES, "too-many-attributes", 400, "an element has too many attributes") \
    X(UNKNOWN_ENCODING, "unknown-encoding", 400, "the stated encoding is not supported") \
    X(BAD_ENCODING, "bad-encoding", 400, "the document is not in its stated encoding") \
    X(UNKNOWN_ELEMENT, "unknown-element", 0, "there is no such element") \
    X(UNKNOWN_ATTRIBUTE, "unknown-attribute", 0, "there is no such attribute") \
    X(MISSING_ATTRIBUTE, "missing-attribute", 0, "an attribute is missing") \
    X(BAD_VALUE, "bad-value", 400, "the value is not understood or out of range") \
    X(IGNORED, "ignored", 0, "this is ignored") \
    X(UNSPOKEN, "unspoken", 0, "this cannot be spoken") \
    X(GUESSED, "guessed", 0, "this may have a different meaning") \
    X(INSIDE_WORD, "inside-word", 0, "this begins or ends within a word") \
    X(ENTITY, "entity", 0, "entities are not expanded") \
    X(MORE_WARNINGS, "more-warnings", 0, "there are more warnings") \
    /* voices */ \
    X(VOICE_FAILED, "voice-failed", 500, "the voice could not speak") \
    X(VOICE_CRASHED, "voice-crashed", 500, "the voice crashed") \
    X(VOICE_TIMEOUT, "voice-timeout", 500, "the voice took too long") \
    X(VOICE_UNAVAILABLE, "voice-unavailable", 503, "no voice is available") \
    X(VOICE_WARNING, "voice-warning", 0, "the voice does this differently") \
    X(NO_SOUND, "no-sound", 0, "there is no such sound") \
    X(NO_RECOGNISER, "no-recogniser", 503, "this server recognises no speech (--recogniser)") \
    X(RECOGNISER_FAILED, "recogniser-failed", 500, "the words could not be recognised") \
    X(NO_COACH, "no-coach", 503, "this server compares no recordings") \
    X(CANCELLED, "cancelled", 500, "it was cancelled") \
    /* access */ \
    X(TOKEN_NEEDED, "token-needed", 401, "this server requires a token") \
    X(BAD_TOKEN, "bad-token", 401, "the token is not from this server") \
    X(EXPIRED_TOKEN, "expired-token", 401, "the token has expired") \
    X(EARLY_TOKEN, "early-token", 401, "the token is not valid yet") \
    X(REVOKED_TOKEN, "revoked-token", 401, "the token is revoked") \
    X(FORBIDDEN, "forbidden", 403, "the token does not include the right to do that") \
    X(FORBIDDEN_ORIGIN, "forbidden-origin", 403, "pages of that origin may not use this server") \
    X(UNKNOWN_HOST, "unknown-host", 421, "this server does not have that name") \
    /* HTTP and the WebSocket handshake */ \
    X(NOT_FOUND, "not-found", 404, "there is nothing at this address") \
    X(METHOD_NOT_ALLOWED, "method-not-allowed", 405, "this address does not accept that method") \
    X(UNSUPPORTED_MEDIA_TYPE, "unsupported-media-type", 415, "bodies of that type are not accepted") \
    X(UPGRADE_REQUIRED, "upgrade-required", 426, "this is the address of the WebSocket") \
    X(BAD_REQUEST, "bad-request", 400, "this is not an HTTP request") \
    X(BAD_HEADER, "bad-header", 400, "a header is malformed") \
    X(BAD_HOST, "bad-host", 400, "there must be exactly one Host header") \
    X(BAD_LENGTH, "bad-length", 400, "the body's length must be given once, in digits") \
    X(BAD_CHUNK, "bad-chunk", 400, "the body's chunks are malformed (RFC 9112, 7.1)") \
    X(BAD_TARGET, "bad-target", 400, "the address is malformed") \
    X(BAD_ESCAPE, "bad-escape", 400, "% must be followed by two hexadecimal digits") \
    X(BAD_FORM, "bad-form", 400, "the body is not a form with a file 'fap'") \
    X(REQUEST_TIMEOUT, "request-timeout", 408, "the request did not arrive in time") \
    X(URI_TOO_LONG, "uri-too-long", 414, "the address is too long") \
    X(HEADERS_TOO_LARGE, "headers-too-large", 431, "the headers are too large") \
    X(UNKNOWN_METHOD, "unknown-method", 501, "this method is not supported") \
    X(UNKNOWN_CODING, "unknown-coding", 501, "the only supported transfer coding is chunked") \
    X(UNKNOWN_VERSION, "unknown-version", 505, "only HTTP/1.1 is supported") \
    X(UNKNOWN_EXPECTATION, "unknown-expectation", 417, "the only supported expectation is 100-continue") \
    X(BAD_HANDSHAKE, "bad-handshake", 400, "a WebSocket is opened with an HTTP/1.1 GET") \
    X(UNKNOWN_PROTOCOL, "unknown-protocol", 400, "there is no such sub-protocol") \
    /* files: one code per kind */ \
    X(BAD_SPEECH_PACK, "bad-speech-pack", 0, "this is not a speech pack") \
    X(BAD_ALPHABET, "bad-alphabet", 0, "this is not a phone alphabet") \
    X(BAD_SHAPE_TABLE, "bad-shape-table", 0, "this is not a table of mouth shapes") \
    X(BAD_EXPRESSIONS, "bad-expressions", 400, "this is not a library of expressions") \
    X(BAD_BOUNDARIES, "bad-boundaries", 0, "this is not a table of phone boundaries") \
    X(BAD_NORMALIZATION, "bad-normalization", 0, "this is not a file of normalisation rules") \
    X(BAD_LEXICON, "bad-lexicon", 400, "this is not a pronunciation lexicon") \
    X(BAD_CAST, "bad-cast", 400, "this is not the cast of a work") \
    X(BAD_MODEL, "bad-model", 0, "this is not a head model") \
    X(BAD_FAP, "bad-fap", 400, "this is not a .fap file") \
    X(BAD_SOUND, "bad-sound", 400, "this is not a readable sound file") \
    X(BAD_TIMES, "bad-times", 0, "these are not times of words and phones") \
    X(BAD_TRANSCRIPTION, "bad-transcription", 0, "this is not a timed transcription") \
    X(BAD_CURVES, "bad-curves", 0, "these are not measured curves with their phones") \
    X(BAD_RESULTS, "bad-results", 0, "this is not a table of results") \
    X(BAD_NETWORK, "bad-network", 0, "this is not a lip recogniser's network") \
    X(BAD_STIMULI, "bad-stimuli", 0, "this is not a set of stimuli") \
    X(BAD_VOICE_CONFIG, "bad-voice-config", 0, "these are not voice settings") \
    X(BAD_VOICE_LIST, "bad-voice-list", 0, "this is not a list of voices") \
    X(BAD_SETTINGS, "bad-settings", 0, "this is not a settings file") \
    X(BAD_SECRETS, "bad-secrets", 0, "this is not a file of secrets or of revocations") \
    X(BAD_WORK, "bad-work", 400, "this is not a readable work") \
    X(BAD_INDEX, "bad-index", 0, "this is not a library index") \
    X(BAD_CACHE, "bad-cache", 0, "this is not a sentence cache") \
    /* programs */ \
    X(BAD_OPTION, "bad-option", 0, "there is no such option") \
    X(CANNOT_LISTEN, "cannot-listen", 0, "cannot listen on the address") \
    X(MISALIGNED, "misaligned", 400, "the text and the recording do not match") \
    X(NO_REFERENCE, "no-reference", 0, "there is no voice to align with") \
    X(FILM_FAILED, "film-failed", 503, "the film cannot be made")
/* clang-format on */

#endif
