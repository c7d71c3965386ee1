import { ssrRenderAttrs } from "vue/server-renderer";
import { useSSRContext } from "vue";
import { _ as _export_sfc } from "./plugin-vue_export-helper.1tPrXgE0.js";
const __pageData = JSON.parse('{"title":"Command line","description":"","frontmatter":{},"headers":[],"relativePath":"protocol/cli.md","filePath":"protocol/cli.md"}');
const _sfc_main = { name: "protocol/cli.md" };
function _sfc_ssrRender(_ctx, _push, _parent, _attrs, $props, $setup, $data, $options) {
  _push(`<div${ssrRenderAttrs(_attrs)}><h1 id="command-line" tabindex="-1">Command line <a class="header-anchor" href="#command-line" aria-label="Permalink to &quot;Command line&quot;">​</a></h1><p>What each program says when it is asked for <code>--help</code>.</p><h2 id="facciad" tabindex="-1">facciad <a class="header-anchor" href="#facciad" aria-label="Permalink to &quot;facciad&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: facciad [OPTION]...</span></span>
<span class="line"><span>Serves the talking head: a page, a WebSocket and HTTP (protocol/README.md says how).</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --config FILE            settings as JSON; the members stand in brackets below</span></span>
<span class="line"><span>      --print-config           print the settings in force as such a file, and exit</span></span>
<span class="line"><span>      --print-schema           print the JSON Schema of such a file, and exit</span></span>
<span class="line"><span>  -h, --help                   print this and exit</span></span>
<span class="line"><span>      --version                print the version and exit</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --host ADDRESS           listen on this address, on all that a name or an interface has, or with * on all (127.0.0.1) [listen.host]</span></span>
<span class="line"><span>      --port N                 listen on this port; 0 = any free one, 0 to 65535 (8080) [listen.port]</span></span>
<span class="line"><span>      --remote                 allow an ADDRESS that other machines can reach [listen.remote]</span></span>
<span class="line"><span>      --tls-cert FILE          speak TLS (https:, wss:) with this certificate and its chain, in PEM; other machines that come without TLS are sent to https: [listen.tls_cert]</span></span>
<span class="line"><span>      --tls-key FILE           the key of --tls-cert, in PEM [listen.tls_key]</span></span>
<span class="line"><span>      --tls-self-signed FOLDER speak TLS with a certificate of its own, made in FOLDER when there is none that is still good: for a home, whose devices trust it once they have taken FOLDER/ca.pem [listen.tls_self_signed]</span></span>
<span class="line"><span>      --hsts SECONDS           tell browsers that came by TLS to use nothing else for so long (Strict-Transport-Security); 0 = off, 0 to 63072000 (0) [listen.hsts]</span></span>
<span class="line"><span>      --origin ORIGIN          let pages from there in, e.g. https://example.org; null = files; * = all; may be repeated [access.origins]</span></span>
<span class="line"><span>      --host-name NAME         a name or address by which others ask for this daemon, besides localhost and, with --remote, the machine&#39;s own name and its addresses; * = any; may be repeated [access.host_names]</span></span>
<span class="line"><span>      --embed ORIGIN           pages from there may frame the daemon&#39;s pages of texts and of the face; * = all; may be repeated [access.embed]</span></span>
<span class="line"><span>      --editing                let who may operate save gestures, and works into the library, over HTTP [access.editing]</span></span>
<span class="line"><span>      --secret-file FILE       demand tokens signed with a secret of this file (one in each line) [access.secret_file]</span></span>
<span class="line"><span>      --revoked-file FILE      tokens that count no more, as &#39;faccia token --revoke&#39; writes them (one in each line) [access.revoked_file]</span></span>
<span class="line"><span>      --lang TAG               language of requests that name none (it) [speech.lang]</span></span>
<span class="line"><span>      --lexicon FILE           pronunciations for all texts, in the Pronunciation Lexicon Specification of the W3C (PLS); may be repeated: for the same words, the first file has the say [speech.lexicons]</span></span>
<span class="line"><span>      --contacts engine|on|off whether lips that must touch do so whatever the engine makes, in requests that do not say on or off (engine) [speech.contacts]</span></span>
<span class="line"><span>      --workers N              processes for each voice plugin, 1 to 64 (1) [voices.workers]</span></span>
<span class="line"><span>      --spare-workers N        as many more while one takes long over a sentence and others wait, or does not answer; 0 = none, 0 to 64 (1) [voices.spare_workers]</span></span>
<span class="line"><span>      --voice-start S          requests wait so long for voices that are still starting; then they do without those, 0.1 to 3600 (30) [voices.start_seconds]</span></span>
<span class="line"><span>      --deadline-base S        a sentence of which nothing has come for so long is given up, and its worker is killed, 0.1 to 3600 (10) [voices.deadline_base]</span></span>
<span class="line"><span>      --deadline-per-byte S    added to that for each byte of the sentence&#39;s text, 0 to 10 (0.05) [voices.deadline_per_byte]</span></span>
<span class="line"><span>      --deadline-most X        the longest that a sentence may take in all, in multiples of that time, 1 to 1000 (10) [voices.deadline_most]</span></span>
<span class="line"><span>      --worker-processor X     the processor time that it may take, in multiples of the same time, 0.01 to 1000 (20) [voices.processor]</span></span>
<span class="line"><span>      --worker-memory N        address space of a worker, megabytes, 64 to 1048576 (4096) [voices.memory_megabytes]</span></span>
<span class="line"><span>      --sandbox on|off         workers are refused the network, programs and other system calls that their plugin does not need (on) [voices.sandbox]</span></span>
<span class="line"><span>      --boundaries heard|own   phones begin where they are heard, as was measured of the voice, or where the voice itself says (heard) [voices.boundaries]</span></span>
<span class="line"><span>      --cache N                keep finished sentences in memory, up to so many megabytes; 0 = none, 0 to 65536 (64) [voices.cache_megabytes]</span></span>
<span class="line"><span>      --cache-file FILE        keep them on disk too, in this file, which must be such a cache or not be there yet [voices.cache_file]</span></span>
<span class="line"><span>      --cache-file-size N      the most that this file may take, megabytes, 1 to 1048576 (1024) [voices.cache_file_megabytes]</span></span>
<span class="line"><span>      --voice-config FILE      JSON object: the settings of each plugin, by its name [voices.plugins]</span></span>
<span class="line"><span>      --cluster URL            share rooms and finished sentences with other daemons, and the voices of faccia-worker, over the Redis at redis://[[USER]:PASSWORD@]HOST[:PORT][/N] [cluster.address]</span></span>
<span class="line"><span>      --cluster-keep N         a sentence that nobody asks for stays there for so many hours, 1 to 100000 (168) [cluster.keep_hours]</span></span>
<span class="line"><span>      --cluster-queue N        sentences that may wait there for the workers of one voice plugin; what is made ahead has half of it, 1 to 100000 (1000) [cluster.queue]</span></span>
<span class="line"><span>      --max-text N             longest text of one request, bytes, 1 to 104857600 (100000) [limits.text_bytes]</span></span>
<span class="line"><span>      --max-message N          longest message of a client, bytes, 64 to 209715200 (262144) [limits.message_bytes]</span></span>
<span class="line"><span>      --max-play N             longest recording that is uploaded, or .fap file in the folder of recordings, bytes, 1024 to 1073741824 (16777216) [limits.play_bytes]</span></span>
<span class="line"><span>      --max-scene N            longest scene that is kept, bytes, 64 to 16777216 (262144) [limits.scene_bytes]</span></span>
<span class="line"><span>      --max-scenes N           how many scenes are kept, 1 to 10000 (200) [limits.scenes]</span></span>
<span class="line"><span>      --max-queue N            utterances that may wait on one stream, 1 to 10000 (32) [limits.queue]</span></span>
<span class="line"><span>      --max-open N             texts that one client may be writing at a time, 1 to 1000 (8) [limits.open]</span></span>
<span class="line"><span>      --open-seconds S         a text that is being written, and is not for so many seconds, is closed; 0 = never, 0 to 86400 (20) [limits.open_seconds]</span></span>
<span class="line"><span>      --max-voices N           how many people may be heard who speak themselves, 0 to 10000 (16) [limits.voices]</span></span>
<span class="line"><span>      --voice-seconds S        where so many seconds of somebody&#39;s voice wait, all but the last 0.2 s is left out, 1 to 60 (2) [limits.voice_seconds]</span></span>
<span class="line"><span>      --max-connections N      how many connections may be open, 1 to 100000 (1000) [limits.connections]</span></span>
<span class="line"><span>      --max-rooms N            how many rooms may have somebody in them, 1 to 100000 (100) [limits.rooms]</span></span>
<span class="line"><span>      --max-rooms-per-address N how many of them one address, or one token&#39;s subject, may have made; 0 = no limit of its own, 0 to 100000 (25) [limits.address_rooms]</span></span>
<span class="line"><span>      --max-voices-per-address N how many people of one address or subject may be heard; 0 = no limit of its own, 0 to 10000 (8) [limits.address_voices]</span></span>
<span class="line"><span>      --max-per-address N      how many of one address, or of one token&#39;s subject, on all daemons of a cluster; 0 = no limit of its own, 0 to 100000 (250) [limits.address_connections]</span></span>
<span class="line"><span>      --max-requests N         utterances and POSTs of one address or subject in a minute, on all daemons of a cluster; 0 = no limit, 0 to 1000000 (1200) [limits.address_requests]</span></span>
<span class="line"><span>      --send-bytes N           media for a client wait while so many bytes are unsent, 4096 to 1073741824 (262144) [limits.send_bytes]</span></span>
<span class="line"><span>      --send-bytes-max N       a client with so many unsent bytes is closed as too slow, 65536 to 1073741824 (4194304) [limits.send_bytes_max]</span></span>
<span class="line"><span>      --lag-seconds N          in a room, media that have waited for so many seconds are left out, 1 to 3600 (5) [limits.lag_seconds]</span></span>
<span class="line"><span>      --stall-seconds N        a client that takes nothing for so many seconds is closed, 1 to 3600 (10) [limits.stall_seconds]</span></span>
<span class="line"><span>      --ping-seconds N         a socket that is silent for so many seconds is pinged, and closed when it stays silent for a third longer, 1 to 3600 (30) [limits.ping_seconds]</span></span>
<span class="line"><span>      --stop-seconds N         after SIGTERM, speech may go on for so many seconds, 0 to 3600 (5) [limits.stop_seconds]</span></span>
<span class="line"><span>      --hold S                 what is said over HTTP to an empty room waits so many seconds for somebody to join, 0 to 86400 (0) [limits.hold_seconds]</span></span>
<span class="line"><span>      --library-align N        recordings of the library are aligned to their texts in the background, by so many per cent of one processor at most, and only by what nobody else wants; 0 = when their voice is asked for, 0 to 100 (50) [library.align_percent]</span></span>
<span class="line"><span>      --library-ahead VOICE    the library&#39;s works in this voice&#39;s language are spoken ahead while it has nothing else to do, and kept as finished sentences are: what is asked for later is heard at once [library.ahead]</span></span>
<span class="line"><span>      --library-ahead-size N   so many megabytes of sound at most; 0 = three quarters of what is kept of finished sentences, 0 to 1048576 (0) [library.ahead_megabytes]</span></span>
<span class="line"><span>      --log text|json          how log lines look (text) [log.format]</span></span>
<span class="line"><span>      --models DIR             heads and language packs [paths.models]</span></span>
<span class="line"><span>      --web DIR                the page and its scripts [paths.web]</span></span>
<span class="line"><span>      --media DIR              recordings that may be played: .fap files with their sound [paths.media]</span></span>
<span class="line"><span>      --scenes DIR             scenes that operators keep: who may operate changes them [paths.scenes]</span></span>
<span class="line"><span>      --plugins DIR            voice plugins [paths.plugins]</span></span>
<span class="line"><span>      --worker FILE            the program that runs voice plugins [paths.worker]</span></span>
<span class="line"><span>      --gestures DIR           gestures of your own, as the Face Player writes them, besides those of the models [paths.gestures]</span></span>
<span class="line"><span>      --library DIR            works that may be read, searched and heard: TEI, EPUB, Markdown, text, APML, JSML, SSML [paths.library]</span></span>
<span class="line"><span>      --library-index FILE     the index of the library, made when it is not there; without it, a file in the cache folder: that of systemd, or faccia/ in $XDG_CACHE_HOME or ~/.cache [paths.library_index]</span></span>
<span class="line"><span>      --lexicons DIR           pronunciations that texts may name (SSML&#39;s lexicon): its .pls files [paths.lexicons]</span></span>
<span class="line"><span>      --audio DIR              sound files that texts may name (SSML&#39;s audio) [paths.audio]</span></span>
<span class="line"><span></span></span>
<span class="line"><span>Every such option can also be given in the environment, as FACCIA_PORT for --port, and so on; the file is</span></span>
<span class="line"><span>$FACCIA_CONFIG. Options override the environment, which overrides the file.</span></span></code></pre></div><h2 id="faccia" tabindex="-1">faccia <a class="header-anchor" href="#faccia" aria-label="Permalink to &quot;faccia&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia [SETTING]... COMMAND [OPTION]...</span></span>
<span class="line"><span>The talking head without a network.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  say          speak a text: its sound, its face animation, its timing</span></span>
<span class="line"><span>  timed        the face for recorded speech, from a timed transcription</span></span>
<span class="line"><span>  play         a recorded face and its sound in other forms</span></span>
<span class="line"><span>  fap          look into, convert, code and draw files of face animation</span></span>
<span class="line"><span>  voices       list the voices</span></span>
<span class="line"><span>  models       list the head models</span></span>
<span class="line"><span>  head         a head as an avatar for other programs (GLB, VRM); heads of other origin</span></span>
<span class="line"><span>  expressions  list the expressions, or write how they look</span></span>
<span class="line"><span>  eval         measure how well the lips can be read, engine by engine</span></span>
<span class="line"><span>  stimuli      make a listening test: speech in noise, with and without a face</span></span>
<span class="line"><span>  anova        analyse the results of such a test</span></span>
<span class="line"><span>  fit          make a speech pack from recordings of a speaker</span></span>
<span class="line"><span>  align        times and face of a recording with its text</span></span>
<span class="line"><span>  hear         the face of a voice whose words nobody knows, while it speaks</span></span>
<span class="line"><span>  life         what the face does of itself, in figures</span></span>
<span class="line"><span>  library      read a folder of works and tell what is in it, and what is wrong</span></span>
<span class="line"><span>  read         tell how a text is read aloud, word by word</span></span>
<span class="line"><span>  lexicon      check a file of pronunciations</span></span>
<span class="line"><span>  check        tell what in a text with markup would not be acted on</span></span>
<span class="line"><span>  token        sign a token for a daemon that demands them</span></span>
<span class="line"><span></span></span>
<span class="line"><span>&#39;faccia COMMAND --help&#39; tells more. The daemon is facciad, whose settings these are, too:</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --config FILE            settings as JSON; the members stand in brackets below</span></span>
<span class="line"><span>  -h, --help                   print this and exit</span></span>
<span class="line"><span>      --version                print the version and exit</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --lang TAG               language of requests that name none (it) [speech.lang]</span></span>
<span class="line"><span>      --lexicon FILE           pronunciations for all texts, in the Pronunciation Lexicon Specification of the W3C (PLS); may be repeated: for the same words, the first file has the say [speech.lexicons]</span></span>
<span class="line"><span>      --contacts engine|on|off whether lips that must touch do so whatever the engine makes, in requests that do not say on or off (engine) [speech.contacts]</span></span>
<span class="line"><span>      --voice-start S          requests wait so long for voices that are still starting; then they do without those, 0.1 to 3600 (30) [voices.start_seconds]</span></span>
<span class="line"><span>      --deadline-base S        a sentence of which nothing has come for so long is given up, and its worker is killed, 0.1 to 3600 (10) [voices.deadline_base]</span></span>
<span class="line"><span>      --deadline-per-byte S    added to that for each byte of the sentence&#39;s text, 0 to 10 (0.05) [voices.deadline_per_byte]</span></span>
<span class="line"><span>      --deadline-most X        the longest that a sentence may take in all, in multiples of that time, 1 to 1000 (10) [voices.deadline_most]</span></span>
<span class="line"><span>      --worker-processor X     the processor time that it may take, in multiples of the same time, 0.01 to 1000 (20) [voices.processor]</span></span>
<span class="line"><span>      --worker-memory N        address space of a worker, megabytes, 64 to 1048576 (4096) [voices.memory_megabytes]</span></span>
<span class="line"><span>      --sandbox on|off         workers are refused the network, programs and other system calls that their plugin does not need (on) [voices.sandbox]</span></span>
<span class="line"><span>      --boundaries heard|own   phones begin where they are heard, as was measured of the voice, or where the voice itself says (heard) [voices.boundaries]</span></span>
<span class="line"><span>      --voice-config FILE      JSON object: the settings of each plugin, by its name [voices.plugins]</span></span>
<span class="line"><span>      --log text|json          how log lines look (text) [log.format]</span></span>
<span class="line"><span>      --models DIR             heads and language packs [paths.models]</span></span>
<span class="line"><span>      --web DIR                the page and its scripts [paths.web]</span></span>
<span class="line"><span>      --plugins DIR            voice plugins [paths.plugins]</span></span>
<span class="line"><span>      --worker FILE            the program that runs voice plugins [paths.worker]</span></span>
<span class="line"><span>      --gestures DIR           gestures of your own, as the Face Player writes them, besides those of the models [paths.gestures]</span></span>
<span class="line"><span>      --lexicons DIR           pronunciations that texts may name (SSML&#39;s lexicon): its .pls files [paths.lexicons]</span></span>
<span class="line"><span>      --audio DIR              sound files that texts may name (SSML&#39;s audio) [paths.audio]</span></span>
<span class="line"><span></span></span>
<span class="line"><span>Every such option can also be given in the environment, as FACCIA_LANG for --lang, and so on; the file is</span></span>
<span class="line"><span>$FACCIA_CONFIG. Options override the environment, which overrides the file.</span></span></code></pre></div><h3 id="faccia-say" tabindex="-1">faccia say <a class="header-anchor" href="#faccia-say" aria-label="Permalink to &quot;faccia say&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia say [OPTION]... (TEXT | --file FILE | -)</span></span>
<span class="line"><span>Speaks TEXT, a file, or standard input (-). Without FILE the timing is told.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)</span></span>
<span class="line"><span>  -v, --voice ID       a voice that &#39;faccia voices&#39; lists</span></span>
<span class="line"><span>      --gender any|female|male</span></span>
<span class="line"><span>                       of the voice, where none is named (any)</span></span>
<span class="line"><span>  -e, --engine NAME    visible-speech engine: dominance, cohen-massaro, context, syllable or table</span></span>
<span class="line"><span>                       (dominance)</span></span>
<span class="line"><span>      --markup auto|plain|apml|jsml|ssml|emotionml|bml|fml</span></span>
<span class="line"><span>                       what the text is (auto: found from the text)</span></span>
<span class="line"><span>  -r, --rate WPM       words per minute, 40 to 500 (the voice&#39;s own)</span></span>
<span class="line"><span>      --pitch FACTOR   0.25 to 4 (1)</span></span>
<span class="line"><span>      --volume FACTOR  0.25 to 4 (1)</span></span>
<span class="line"><span>      --fps N          FAP frames per second, 1 to 120 (25)</span></span>
<span class="line"><span>      --seed N         another life of the face; the same number gives the same face (0)</span></span>
<span class="line"><span>      --life FACTOR    strength of the signs of life, 0 to 2 (1)</span></span>
<span class="line"><span>      --blend auto|regions|weighted</span></span>
<span class="line"><span>                       how expressions share the mouth with speech (auto)</span></span>
<span class="line"><span>      --contacts engine|on|off</span></span>
<span class="line"><span>                       lips that must touch do, whatever the engine makes; engine: off for the</span></span>
<span class="line"><span>                       baselines cohen-massaro and table, on for the others (engine)</span></span>
<span class="line"><span>      --normalize on|off</span></span>
<span class="line"><span>                       numbers, signs and short forms become words; off: they are left to the voice</span></span>
<span class="line"><span>                       (on)</span></span>
<span class="line"><span>      --open           speak standard input (-) while it is written</span></span>
<span class="line"><span>      --still          only the lips move</span></span>
<span class="line"><span>  -f, --file FILE      the text</span></span>
<span class="line"><span>      --voice-file FILE  somebody&#39;s recorded voice in place of a text, as &#39;faccia hear FILE&#39;</span></span>
<span class="line"><span>      --open           speak standard input (-) while it is written</span></span>
<span class="line"><span>      --audio DIR      sound files that the text may name (SSML&#39;s audio); default $FACCIA_AUDIO</span></span>
<span class="line"><span>      --lexicon FILE   how to say words (W3C PLS); may be repeated</span></span>
<span class="line"><span>      --wav FILE       the sound, mono 16 bit</span></span>
<span class="line"><span>      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)</span></span>
<span class="line"><span>      --fapc FILE      the same at a few kilobits a second</span></span>
<span class="line"><span>      --ogg FILE       the sound as Opus in Ogg</span></span>
<span class="line"><span>      --ndjson FILE    a line for each event and each frame</span></span>
<span class="line"><span>      --json FILE      phones, words and marks with their times</span></span>
<span class="line"><span>      --arkit FILE     the face as weights of ARKit&#39;s 52 shapes, in Live Link Face&#39;s columns (CSV)</span></span>
<span class="line"><span>      --arkit-ndjson FILE  the same weights as lines of JSON</span></span>
<span class="line"><span>      --visemes FILE   visemes with their times, and the 15 weights of each frame (lines of JSON)</span></span>
<span class="line"><span>      --vtt FILE       captions with word times; --textgrid FILE sentences, words, phones for Praat</span></span>
<span class="line"><span>      --osc HOST:PORT  the face, as it goes on, to a puppet of the VMC protocol</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>FILE - is standard input or output. Exit status: 0 spoken, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-timed" tabindex="-1">faccia timed <a class="header-anchor" href="#faccia-timed" aria-label="Permalink to &quot;faccia timed&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia timed [OPTION]... FILE</span></span>
<span class="line"><span>Writes the face of a timed phonetic transcription to standard output, as MPEG-4 FAPs (text, version 2.1).</span></span>
<span class="line"><span>Each line of FILE is &#39;INDEX: OFFSET SYMBOL&#39;, OFFSET being the phone&#39;s first byte in the sound file; the last</span></span>
<span class="line"><span>line has no symbol.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -l, --lang TAG      a language with a table of visemes (pt-BR)</span></span>
<span class="line"><span>  -e, --engine NAME   visible-speech engine (context)</span></span>
<span class="line"><span>      --fps N         frames per second, 1 to 120 (30)</span></span>
<span class="line"><span>      --header BYTES  of the sound file before its first sample (44)</span></span>
<span class="line"><span>      --hz RATE       its samples per second (16000)</span></span>
<span class="line"><span>      --frame BYTES   of one sample of all its channels (2)</span></span></code></pre></div><h3 id="faccia-play" tabindex="-1">faccia play <a class="header-anchor" href="#faccia-play" aria-label="Permalink to &quot;faccia play&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia play [OPTION]... FILE.fap [SOUND]</span></span>
<span class="line"><span>Reads a face animation and its sound (any format of libsndfile; without SOUND: a file of the same name beside it,</span></span>
<span class="line"><span>or silence) as the daemon does, and writes it down. Without a file to write, lines of JSON go to standard output.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --ndjson FILE    a line for each frame</span></span>
<span class="line"><span>      --wav FILE       the sound, mono 16 bit</span></span>
<span class="line"><span>      --ogg FILE       the sound as Opus in Ogg</span></span>
<span class="line"><span>      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)</span></span>
<span class="line"><span>      --fapc FILE      the same at a few kilobits a second</span></span>
<span class="line"><span>      --arkit FILE     the face as weights of ARKit&#39;s 52 shapes, in the columns of Live Link Face (CSV)</span></span>
<span class="line"><span>      --arkit-ndjson FILE  the same weights as lines of JSON</span></span>
<span class="line"><span>      --visemes FILE   the 15 visemes of FAP 1, frame by frame (lines of JSON)</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-fap" tabindex="-1">faccia fap <a class="header-anchor" href="#faccia-fap" aria-label="Permalink to &quot;faccia fap&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia fap info FILE...</span></span>
<span class="line"><span>       faccia fap convert [--fps N] [--name NAME] FILE [OUT.fap]</span></span>
<span class="line"><span>       faccia fap encode [--quality N] [--fps N] FILE [OUT.fapc]</span></span>
<span class="line"><span>       faccia fap decode [--name NAME] FILE.fapc [OUT.fap]</span></span>
<span class="line"><span>       faccia fap plot [--fap LIST] [--from S] [--to S] FILE [OUT.svg]</span></span>
<span class="line"><span>Files of face animation: .fap of versions 2.0 and 2.1 (MPEG-4 FAPs as text), with or without a header,</span></span>
<span class="line"><span>and .fapc (the same at a few kilobits a second). Which of them FILE is shows in its first bytes.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  info     version, name, rate, length, what each FAP does, and what it costs coded</span></span>
<span class="line"><span>  convert  writes version 2.1 with a header, at another rate if wanted (1 to 1000)</span></span>
<span class="line"><span>  encode   to .fapc; quality 0 keeps every value, 31 is the coarsest (5)</span></span>
<span class="line"><span>  decode   to .fap</span></span>
<span class="line"><span>  plot     draws FAPs over time as SVG: LIST has names or numbers with commas</span></span>
<span class="line"><span>           (the eight that move most); S are seconds</span></span>
<span class="line"><span>FILE - is standard input, OUT - or none standard output. Exit status: 0 done, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-voices" tabindex="-1">faccia voices <a class="header-anchor" href="#faccia-voices" aria-label="Permalink to &quot;faccia voices&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia voices [--lang TAG] [--model NAME] [--json]</span></span>
<span class="line"><span>Lists the voices: id, language, gender, quality, name.</span></span>
<span class="line"><span>With a model those that suit that head.</span></span></code></pre></div><h3 id="faccia-models" tabindex="-1">faccia models <a class="header-anchor" href="#faccia-models" aria-label="Permalink to &quot;faccia models&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia models [--json]</span></span>
<span class="line"><span>Lists the head models: name, bytes, title.</span></span></code></pre></div><h3 id="faccia-head" tabindex="-1">faccia head <a class="header-anchor" href="#faccia-head" aria-label="Permalink to &quot;faccia head&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia head export NAME [--glb FILE] [--vrm FILE]</span></span>
<span class="line"><span>Writes a head that &#39;faccia models&#39; lists as an avatar for other programs, in the public domain (CC0): ARKit&#39;s 52 shapes and 15</span></span>
<span class="line"><span>visemes as morph targets, bones, the expressions of VRM 1.0. Both options write the same: a VRM is a GLB.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --glb FILE       the avatar (standard output when nothing is named)</span></span>
<span class="line"><span>      --vrm FILE       under the name that VRM&#39;s programs look for</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>faccia head import FILE, calibrate HEAD.json, points HEAD.json, check HEAD.json: heads of other origin; needs Node.js</span></span>
<span class="line"><span>(18 or later). &#39;faccia head import --help&#39; tells more.</span></span>
<span class="line"><span>faccia head lips TRACKS: how somebody&#39;s lips moved, for &#39;faccia fit&#39;. &#39;faccia head lips --help&#39; tells more.</span></span>
<span class="line"><span>Of photographs, models/tools of the sources makes heads (portrait/make-portrait.mjs) and sets of pictures (pictures/make-set.mjs).</span></span></code></pre></div><h3 id="faccia-expressions" tabindex="-1">faccia expressions <a class="header-anchor" href="#faccia-expressions" aria-label="Permalink to &quot;faccia expressions&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia expressions [--kind KIND] [--json]</span></span>
<span class="line"><span>       faccia expressions --fap [KIND:]NAME[=INTENSITY]...</span></span>
<span class="line"><span>Lists the expressions: kind, name, and of affects the place on the emotion disc (activation,</span></span>
<span class="line"><span>evaluation, -1 to 1).</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -k, --kind KIND   only those of a kind: affect, performative, certainty...</span></span>
<span class="line"><span>      --json        as JSON</span></span>
<span class="line"><span>      --fap WHAT    writes expressions as MPEG-4 FAPs (text, version 2.1), one frame for each that is</span></span>
<span class="line"><span>                    named: held, at INTENSITY 0 to 1 (1); a KIND that is not given is &#39;affect&#39;</span></span></code></pre></div><h3 id="faccia-eval" tabindex="-1">faccia eval <a class="header-anchor" href="#faccia-eval" aria-label="Permalink to &quot;faccia eval&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia eval [OPTION]... (TEXT | --file FILE | -)</span></span>
<span class="line"><span>       faccia eval [OPTION]... --recording CURVES --phones TIMES [--other CURVES --other-phones TIMES]...</span></span>
<span class="line"><span>Measures lips: how well they can be read that speak TEXT, a file, or standard input (-), for each engine and speech</span></span>
<span class="line"><span>rate; or how near each engine comes to people who were recorded. A table goes to standard output unless --json or --svg</span></span>
<span class="line"><span>say otherwise.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)</span></span>
<span class="line"><span>  -v, --voice ID       a voice that &#39;faccia voices&#39; lists</span></span>
<span class="line"><span>  -e, --engine NAME    visible-speech engine; may be given several times (all that the language has)</span></span>
<span class="line"><span>      --contacts HOW   the layer of contacts over them: on, off, engine (as each has it) or both (both, or engine where</span></span>
<span class="line"><span>                       engines are named)</span></span>
<span class="line"><span>      --ablation       the default engine without its shape, and without its resistance, too</span></span>
<span class="line"><span>  -r, --rates LIST     words per minute, 40 to 500, with commas (80,120,160,200,240,280,320)</span></span>
<span class="line"><span>      --fps N          FAP frames per second, 1 to 120 (25)</span></span>
<span class="line"><span>  -f, --file FILE      the text</span></span>
<span class="line"><span>      --recording FILE curves of a person in mm (as for &#39;faccia fit&#39;); may be repeated, each followed by</span></span>
<span class="line"><span>      --phones FILE    the times of its phones: CSV, TextGrid, .lab, HTK or JSON; IPA, X-SAMPA or ARPAbet</span></span>
<span class="line"><span>      --other FILE     another person who says the same, brought to the same times: how like people are</span></span>
<span class="line"><span>      --other-phones FILE</span></span>
<span class="line"><span>      --shift MS       all predictions are taken so much later, -60 to 60 (0)</span></span>
<span class="line"><span>      --json FILE      all figures</span></span>
<span class="line"><span>      --svg FILE       a picture: the lips&#39; gap over some words, and the measures over the rates</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span></span></span>
<span class="line"><span>lips, held: bilabials closed in a frame that is shown while they sound, throughout their middle third; teeth, held: the</span></span>
<span class="line"><span>same for labiodentals. Both in the phones&#39; own times, as the voice gave them.</span></span>
<span class="line"><span>open, err: opening of vowels against their targets; round, protr: rounding of /o u/ against its targets; antic: how</span></span>
<span class="line"><span>much of it is there in the consonant before; speed, jerk: the largest of the lips&#39; gap; overlap: lips passing through</span></span>
<span class="line"><span>each other; reader: visemes told by a nearest neighbour that learnt from half of the words of the same engine: it</span></span>
<span class="line"><span>measures how well an engine keeps its shapes apart, not whether a person could read them (a plain table does best);</span></span>
<span class="line"><span>usual: the same by always saying the commonest one. How they are taken: server/eval/eval.h.</span></span>
<span class="line"><span>Of recordings, for each parameter: r, the correlation; rms, the error in mm when the prediction may be moved by a</span></span>
<span class="line"><span>constant; affine, when it may be scaled, too; shift, in ms within 60, the one with the highest r, and that r. reader:</span></span>
<span class="line"><span>visemes told by a nearest neighbour that learnt from the people and reads the engine.</span></span>
<span class="line"><span>FILE - is standard input or output. Exit status: 0 measured, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-stimuli" tabindex="-1">faccia stimuli <a class="header-anchor" href="#faccia-stimuli" aria-label="Permalink to &quot;faccia stimuli&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia stimuli --out DIR [OPTION]...</span></span>
<span class="line"><span>Makes a listening test in DIR: every word of a set, in a carrier sentence and in noise, as WAV; the face that speaks it,</span></span>
<span class="line"><span>as FAPs; manifest.json, which lists all; and index.html, a page that presents them in random order and saves the</span></span>
<span class="line"><span>answers as CSV for &#39;faccia anova&#39;. The page needs a running facciad for the head model.</span></span>
<span class="line"><span>Each word comes in three modes: sound alone, and with the face of two engines (or a still face) at the same sound.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -o, --out DIR        where to; made if it is not there</span></span>
<span class="line"><span>  -v, --voice ID       a voice that &#39;faccia voices&#39; lists (the language&#39;s first)</span></span>
<span class="line"><span>  -r, --rate WPM       words per minute, 40 to 500</span></span>
<span class="line"><span>  -e, --engine NAME    of the second and, given again, of the third mode; &#39;still&#39; is a face at rest (the first two</span></span>
<span class="line"><span>                       engines there are)</span></span>
<span class="line"><span>      --faces LIST     who is seen, with commas between: &#39;head&#39;; &#39;pictures&#39; or &#39;pictures:FILE&#39;, a set of pictures (the</span></span>
<span class="line"><span>                       daemon&#39;s, or a file) moved by the first engine; &#39;video:DIR&#39;, films of a real speaker with their</span></span>
<span class="line"><span>                       own sound: DIR/WORD.mp4 or .webm, WORD.wav, and words.json, {&quot;WORD&quot;: {&quot;start&quot;: S, &quot;end&quot;: S}} (head)</span></span>
<span class="line"><span>      --fps N          FAP frames per second, 1 to 120 (50)</span></span>
<span class="line"><span>      --seed N         another noise (0)</span></span>
<span class="line"><span>      --set FILE       the words (models/stimuli/pt-BR.json: 27 words of two syllables, -12, -18, -24 dB)</span></span>
<span class="line"><span>      --server URL     where the page looks for facciad (http://127.0.0.1:8080)</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>Exit status: 0 made, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-anova" tabindex="-1">faccia anova <a class="header-anchor" href="#faccia-anova" aria-label="Permalink to &quot;faccia anova&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia anova (--csv FILE... | --means FILE)</span></span>
<span class="line"><span>One-way analysis of variance of a listening test: at each signal-to-noise ratio, do the modes of presentation differ,</span></span>
<span class="line"><span>all together and each from each? Prints F, its degrees of freedom, and p, the chance of such an F if they did not.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -c, --csv FILE     answers as the page of &#39;faccia stimuli&#39; writes them (columns listener, mode, snr, correct);</span></span>
<span class="line"><span>                     may be given several times, one file for each listener</span></span>
<span class="line"><span>  -m, --means FILE   instead: CSV with the columns snr, mode, mean, variance, n of the listeners&#39; proportions correct</span></span>
<span class="line"><span>  -h, --help         print this and exit</span></span>
<span class="line"><span>FILE - is standard input. Exit status: 0 analysed, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-fit" tabindex="-1">faccia fit <a class="header-anchor" href="#faccia-fit" aria-label="Permalink to &quot;faccia fit&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia fit [OPTION]... NAME.csv...</span></span>
<span class="line"><span>Fits the coefficients of the visible-speech model to recordings of a speaker, and writes them as a speech pack that</span></span>
<span class="line"><span>inherits all else. How much may move (all vowels and all consonants alike; the targets of viseme groups; from 8</span></span>
<span class="line"><span>recordings on each phone), and how firmly it is held to the pack that it starts from, is chosen for each parameter</span></span>
<span class="line"><span>by what foretells sounds that were held out; where that gains less than its standard error, the parameter is kept as</span></span>
<span class="line"><span>it was.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>NAME.csv holds the curves: a line of names, then time (s) and any of LI, LS, AR, PI, PS, EM, TH, TA, TB, or of the</span></span>
<span class="line"><span>markers of an articulograph (ul_x, ul_z, ll_x, ll_z, jaw_z, tt_x, tt_z, tb_z or tr_z; x forward, z up), all in</span></span>
<span class="line"><span>mm, best at 100 Hz (models/tools/articulograph.py makes it from .mat and .pos files). Frames whose \`confidence\`, or</span></span>
<span class="line"><span>\`LI_confidence\`... of one parameter, is below 0.25 do not count (faccia head lips writes them). Its phones are in</span></span>
<span class="line"><span>NAME.phones.csv (start, end in s, and a name), NAME.TextGrid, NAME.json, NAME.lab or NAME.mlf, in IPA, X-SAMPA or</span></span>
<span class="line"><span>ARPAbet. Recordings of the same phones are averaged.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -b, --base NAME      the pack to start from (it)</span></span>
<span class="line"><span>  -t, --tag TAG        language tag of the new pack (that of the base, then -x-fitted)</span></span>
<span class="line"><span>  -n, --name TEXT      its name (that of the base)</span></span>
<span class="line"><span>      --test NAME.csv  a recording that is not fitted: its error before and after; may be repeated</span></span>
<span class="line"><span>      --rest           the mouth is at rest in the pauses, lips closed, and the curves count from there; without</span></span>
<span class="line"><span>                       this the level of the curves is free, and pauses do not count</span></span>
<span class="line"><span>      --own            the pack is to be of this speaker alone. Without this it goes half of the way from the base to the</span></span>
<span class="line"><span>                       speaker, and moves as far as the base, so that it serves others, too</span></span>
<span class="line"><span>      --strength S     how firmly it is held, in mm, all being let move, instead of what is chosen</span></span>
<span class="line"><span>      --first N        iterations of each trial of the choice (3)</span></span>
<span class="line"><span>      --then N         iterations of the fit itself (10)</span></span>
<span class="line"><span>      --compare        fit the function of Cohen and Massaro to the same, to see its error</span></span>
<span class="line"><span>  -o, --output FILE    the pack; standard output when left out. It is found in models/speech, beside its base</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>Errors are told with the scale that suits the recordings best, those of tests with and without one of their own.</span></span>
<span class="line"><span>Exit status: 0 fitted, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-align" tabindex="-1">faccia align <a class="header-anchor" href="#faccia-align" aria-label="Permalink to &quot;faccia align&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia align [OPTION]... SOUND [--text FILE] [--timing FILE]</span></span>
<span class="line"><span>Finds when the recording SOUND (WAV, FLAC, Ogg, MP3) says each word and phone of its transcript, by itself or</span></span>
<span class="line"><span>from a file of times, and writes timing, face and sound. Without --json, --fap or --wav the timing goes to</span></span>
<span class="line"><span>standard output.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -t, --text FILE      what is said, plain text, UTF-8</span></span>
<span class="line"><span>      --timing FILE    times of the phones: Festival or HTK .lab, .mlf, Praat TextGrid, faccia&#39;s JSON, byte offsets</span></span>
<span class="line"><span>      --names FILE     JSON object: the timing&#39;s names of phones in IPA</span></span>
<span class="line"><span>      --tier NAME      of a TextGrid: has the phones; found by its name when it is not told</span></span>
<span class="line"><span>      --word-tier NAME has the words</span></span>
<span class="line"><span>  -l, --lang TAG       it, pt-BR, tr, en, or any other that a voice speaks (it)</span></span>
<span class="line"><span>      --gender WORD    of the speaker: female or male; found out when it is not told</span></span>
<span class="line"><span>      --fps N          FAP frames per second, 1 to 120 (25)</span></span>
<span class="line"><span>  -e, --engine NAME    visible-speech engine: dominance, cohen-massaro, context, syllable or table</span></span>
<span class="line"><span>                       (dominance)</span></span>
<span class="line"><span>      --contacts engine|on|off</span></span>
<span class="line"><span>                       lips that must touch do, whatever the engine makes; engine: off for the</span></span>
<span class="line"><span>                       baselines cohen-massaro and table, on for the others (engine)</span></span>
<span class="line"><span>      --still          only the lips move</span></span>
<span class="line"><span>      --seed N         another life of the face (0)</span></span>
<span class="line"><span>      --json FILE      phones and words with their times</span></span>
<span class="line"><span>      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)</span></span>
<span class="line"><span>      --wav FILE       the sound, mono 16 bit</span></span>
<span class="line"><span>  -q, --quiet          no progress</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>FILE - is standard input or output. Exit status: 0 done, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-hear" tabindex="-1">faccia hear <a class="header-anchor" href="#faccia-hear" aria-label="Permalink to &quot;faccia hear&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia hear [OPTION]... (SOUND | --raw RATE -)</span></span>
<span class="line"><span>Moves the lips to a voice whose words nobody knows, as it goes on: SOUND is a recording (WAV, FLAC, Ogg, MP3); with</span></span>
<span class="line"><span>--raw it is standard input, 16 bit samples as a microphone gives them:</span></span>
<span class="line"><span>arecord -f S16_LE -r 16000 -t raw | faccia hear --raw 16000 -</span></span>
<span class="line"><span>Where the text is known &#39;faccia align&#39; is the better way. Without a file to write, lines of JSON go to standard output. In a room of a daemon: faccia-live.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -l, --lang TAG       whose lips: it, pt-BR, tr, en or any other (it)</span></span>
<span class="line"><span>      --lookahead MS   what is heard after a moment before it is shown: 0, 40, 80 or 120 (80)</span></span>
<span class="line"><span>      --raw RATE       of standard input, 8000 to 96000 samples a second</span></span>
<span class="line"><span>      --channels N     of standard input, 1 to 8 (1)</span></span>
<span class="line"><span>      --fps N          FAP frames per second, 1 to 120 (25)</span></span>
<span class="line"><span>  -e, --engine NAME    what moves the mouth: network, or the engine dominance, cohen-massaro or table (network)</span></span>
<span class="line"><span>      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)</span></span>
<span class="line"><span>      --json FILE      the sounds by what is seen of them, with their times and how likely each was</span></span>
<span class="line"><span>      --ndjson FILE    a line for each of them and each frame, as they come</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>FILE - is standard output. Exit status: 0 done, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-life" tabindex="-1">faccia life <a class="header-anchor" href="#faccia-life" aria-label="Permalink to &quot;faccia life&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia life [OPTION]... [TEXT | --file FILE | -]</span></span>
<span class="line"><span>Lets the face live, for some time without speech or while it speaks TEXT, and prints in figures what it</span></span>
<span class="line"><span>did: blinks, saccades, where it looked, how the head moved. Only the life of the face is counted.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --seconds N      without a text: how long, 1 to 86400 (600)</span></span>
<span class="line"><span>      --seed N         another life; the same number gives the same life (0)</span></span>
<span class="line"><span>      --strength X     0 to 2; 1 is as people are (1)</span></span>
<span class="line"><span>  -l, --lang TAG       language of the text, any that a voice speaks (it)</span></span>
<span class="line"><span>  -f, --file FILE      the text</span></span>
<span class="line"><span>      --fps N          frames per second, 25 to 1000 (100)</span></span>
<span class="line"><span>      --fap FILE       the face, MPEG-4 FAPs as text (version 2.1)</span></span>
<span class="line"><span>  -h, --help           print this and exit</span></span>
<span class="line"><span>FILE - is standard input or output. Exit status: 0 done, 1 failed, 2 wrong usage.</span></span></code></pre></div><h3 id="faccia-library" tabindex="-1">faccia library <a class="header-anchor" href="#faccia-library" aria-label="Permalink to &quot;faccia library&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia library DIR</span></span>
<span class="line"><span>       faccia library export [OPTION]... DIR WORK</span></span>
<span class="line"><span>Reads the works of a folder (TEI, EPUB, Markdown, text, APML, JSML, SSML) and tells what is in them and</span></span>
<span class="line"><span>what is wrong, with file, line and column. Exits with 1 when something could not be read.</span></span>
<span class="line"><span>export writes a work down as a book that is heard, captions, and more: faccia library export --help</span></span></code></pre></div><h3 id="faccia-read" tabindex="-1">faccia read <a class="header-anchor" href="#faccia-read" aria-label="Permalink to &quot;faccia read&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia read [OPTION]... TEXT...</span></span>
<span class="line"><span>Tells how TEXT (- = standard input) is read aloud, without a voice: on each line a word or words, as</span></span>
<span class="line"><span>they will be said, a tab, and what stands for them in the text. Behind words that may have been meant</span></span>
<span class="line"><span>otherwise is a question mark.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -l, --lang TAG         the text&#39;s language (the daemon&#39;s default)</span></span>
<span class="line"><span>  -f, --file FILE        read the text from a file</span></span>
<span class="line"><span>  -m, --markup NAME      plain, apml, jsml, ssml, emotionml, bml, fml, or auto (auto): by the root element</span></span>
<span class="line"><span>  -n, --normalize WHICH  on, or off: numbers, signs and short forms are left to the voice (on)</span></span>
<span class="line"><span>      --lexicon FILE     how to say words (W3C PLS); may be repeated</span></span>
<span class="line"><span>  -w, --words            only the words, on one line with single spaces</span></span></code></pre></div><h3 id="faccia-lexicon" tabindex="-1">faccia lexicon <a class="header-anchor" href="#faccia-lexicon" aria-label="Permalink to &quot;faccia lexicon&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia lexicon check FILE...</span></span>
<span class="line"><span>Reads each FILE as a lexicon (W3C PLS 1.0), and tells how many spellings of which language</span></span>
<span class="line"><span>it has, and what in it is wrong or is not acted on: FILE:LINE:COLUMN: warning|error: message.</span></span>
<span class="line"><span>The exit code is 1 when a file, or a lexeme of it, cannot be used.</span></span></code></pre></div><h3 id="faccia-check" tabindex="-1">faccia check <a class="header-anchor" href="#faccia-check" aria-label="Permalink to &quot;faccia check&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia check [OPTION]... FILE...</span></span>
<span class="line"><span>Reads each FILE (- = standard input) as it would be spoken, and tells what in it is wrong or is not acted on:</span></span>
<span class="line"><span>FILE:LINE:COLUMN: warning|error: message. The exit code is 1 when there is an error.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -m, --markup NAME  plain, apml, jsml, ssml, emotionml, bml, fml, or auto (auto): by the root element</span></span>
<span class="line"><span>      --lexicon FILE how to say words (W3C PLS); may be repeated: its faults are told too</span></span>
<span class="line"><span>  -s, --score        also write what was understood</span></span></code></pre></div><h3 id="faccia-token" tabindex="-1">faccia token <a class="header-anchor" href="#faccia-token" aria-label="Permalink to &quot;faccia token&quot;">​</a></h3><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia token --secret-file FILE --subject NAME [OPTION]...</span></span>
<span class="line"><span>       faccia token --secret-file FILE --revoke TOKEN</span></span>
<span class="line"><span>       faccia token --revoke-subject NAME [--expires TIME]</span></span>
<span class="line"><span>Prints a token that a daemon started with --secret-file FILE accepts; or the line that</span></span>
<span class="line"><span>takes one back, or all that a subject has: it goes into the file of --revoked-file.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --secret-file FILE   a secret of at least 32 bytes in each line; the first signs.</span></span>
<span class="line"><span>                           One can be made so: head -c 32 /dev/urandom | base64</span></span>
<span class="line"><span>  -s, --subject NAME       who it is for; up to 64 bytes</span></span>
<span class="line"><span>      --room NAME          good in this room only</span></span>
<span class="line"><span>      --rights WORDS       of listen, speak, operate, with commas (listen,speak)</span></span>
<span class="line"><span>      --expires TIME       good for so long: 90s, 15m, 12h, 30d (15m)</span></span>
<span class="line"><span>      --revoke TOKEN       that one counts no more</span></span>
<span class="line"><span>      --revoke-subject NAME  those issued up to now for NAME count no more; --expires is how</span></span>
<span class="line"><span>                           long the longest of them is good for</span></span>
<span class="line"><span>  -h, --help               print this and exit</span></span>
<span class="line"><span>Exit status: 0 printed, 1 failed, 2 wrong usage.</span></span></code></pre></div><h2 id="faccia-say-1" tabindex="-1">faccia-say <a class="header-anchor" href="#faccia-say-1" aria-label="Permalink to &quot;faccia-say&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia-say [OPTION]... TEXT...</span></span>
<span class="line"><span>Has a face say the text in a room of a running facciad. TEXT - is standard input.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -r, --room NAME       the room (FACCIA_ROOM, else home)</span></span>
<span class="line"><span>  -u, --url URL         the daemon (FACCIA_URL, else http://127.0.0.1:8080)</span></span>
<span class="line"><span>      --token-file FILE its token (else FACCIA_TOKEN)</span></span>
<span class="line"><span>  -w, --wait            go on when it has been heard, and tell by the exit status</span></span>
<span class="line"><span>  -q, --if-quiet        only when nothing is said there</span></span>
<span class="line"><span>  -p, --priority WORD   background, chat (default) or alarm</span></span>
<span class="line"><span>  -t, --topic NAME      what it is about: takes the place of those that wait with the same</span></span>
<span class="line"><span>  -l, --lang TAG, -v, --voice ID, --rate N, --markup NAME</span></span>
<span class="line"><span>                        as of faccia say</span></span>
<span class="line"><span>  -h, --help            print this and exit</span></span>
<span class="line"><span>      --version         print the version and exit</span></span>
<span class="line"><span>Exit status: 0 accepted, and with --wait heard to its end; 1 failed; 2 wrong usage; 3 nobody is there to hear it;</span></span>
<span class="line"><span>4 something is being said (--if-quiet); 5 it was cut short; 6 nobody can have heard it: the browsers there</span></span>
<span class="line"><span>play no sound until somebody touches them (--wait).</span></span></code></pre></div><h2 id="faccia-live" tabindex="-1">faccia-live <a class="header-anchor" href="#faccia-live" aria-label="Permalink to &quot;faccia-live&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia-live [OPTION]... (SOUND | --raw RATE -)</span></span>
<span class="line"><span>Has a face say in a room of a running facciad what somebody says himself, as it is spoken: SOUND is a recording (WAV, FLAC,</span></span>
<span class="line"><span>Ogg, MP3); with --raw it is 16 bit samples, of standard input as a microphone gives them:</span></span>
<span class="line"><span>arecord -f S16_LE -r 16000 -t raw | faccia-live --room kitchen --raw 16000 -</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -r, --room NAME       the room (FACCIA_ROOM, else home)</span></span>
<span class="line"><span>      --raw RATE[,CHANNELS]  samples a second, 8000 to 96000, of 1 to 8 channels (1)</span></span>
<span class="line"><span>      --lookahead MS    what is heard after a moment before it is shown: 0, 40, 80 (default) or 120</span></span>
<span class="line"><span>  -i, --interrupt       at once: what is being said is cut, and what waits comes afterwards</span></span>
<span class="line"><span>  -q, --if-quiet        only when nothing is said there</span></span>
<span class="line"><span>  -p, --priority WORD   background, chat (default) or alarm</span></span>
<span class="line"><span>  -t, --topic NAME      what it is about: takes the place of those that wait with the same</span></span>
<span class="line"><span>  -l, --lang TAG        whose lips</span></span>
<span class="line"><span>  -e, --engine NAME     as of faccia hear</span></span>
<span class="line"><span>  -u, --url URL         the daemon (FACCIA_URL, else http://127.0.0.1:8080)</span></span>
<span class="line"><span>      --token-file FILE its token (else FACCIA_TOKEN)</span></span>
<span class="line"><span>  -h, --help            print this and exit</span></span>
<span class="line"><span>      --version         print the version and exit</span></span>
<span class="line"><span>What comes through a pipe before its turn, or in a pause, is not heard; a recording waits.</span></span>
<span class="line"><span>Ctrl-C, or the end of the sound, ends it. Exit status: 0 it was said; 1 failed; 2 wrong usage;</span></span>
<span class="line"><span>4 something is being said (--if-quiet); 5 it was cut short.</span></span></code></pre></div><h2 id="faccia-wyoming" tabindex="-1">faccia-wyoming <a class="header-anchor" href="#faccia-wyoming" aria-label="Permalink to &quot;faccia-wyoming&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia-wyoming [OPTION]...</span></span>
<span class="line"><span>Speaks for assistants over the Wyoming protocol (Home Assistant, Rhasspy), with the voices of a running facciad.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -l, --listen [ADDRESS:]PORT  where (127.0.0.1:10200; 0 is any free port)</span></span>
<span class="line"><span>  -r, --room NAME         what is spoken is said by the face of that room, too</span></span>
<span class="line"><span>      --silent            silence goes back, as long as the speech: the room&#39;s face alone is heard</span></span>
<span class="line"><span>  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)</span></span>
<span class="line"><span>      --token-file FILE   its token (else FACCIA_TOKEN)</span></span>
<span class="line"><span>  -h, --help              print this and exit</span></span>
<span class="line"><span>      --version           print the version and exit</span></span>
<span class="line"><span>The protocol has no passwords: listen where you trust everybody. Exit status: 0 ended by a signal, 1 failed,</span></span>
<span class="line"><span>2 wrong usage.</span></span></code></pre></div><h2 id="faccia-lva" tabindex="-1">faccia-lva <a class="header-anchor" href="#faccia-lva" aria-label="Permalink to &quot;faccia-lva&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia-lva [OPTION]...</span></span>
<span class="line"><span>Shows in a room of a running facciad what a Linux Voice Assistant does (listening, thinking, muted, timers), and says</span></span>
<span class="line"><span>its answers with the face where the assistant is silent itself.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -a, --assistant URL     its peripheral API (ws://127.0.0.1:6055)</span></span>
<span class="line"><span>  -r, --room NAME         the room (FACCIA_ROOM, else home)</span></span>
<span class="line"><span>  -s, --speak WHEN        the face says the answers: silent (default: when the assistant&#39;s volume is 0 or muted), always,</span></span>
<span class="line"><span>                          never</span></span>
<span class="line"><span>  -l, --lang TAG, -v, --voice ID  of what the face says</span></span>
<span class="line"><span>  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)</span></span>
<span class="line"><span>      --token-file FILE   its token (else FACCIA_TOKEN)</span></span>
<span class="line"><span>  -h, --help              print this and exit</span></span>
<span class="line"><span>      --version           print the version and exit</span></span>
<span class="line"><span>Exit status: 0 ended by a signal, 1 failed, 2 wrong usage.</span></span></code></pre></div><h2 id="faccia-worker" tabindex="-1">faccia-worker <a class="header-anchor" href="#faccia-worker" aria-label="Permalink to &quot;faccia-worker&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia-worker --cluster URL [OPTION]...</span></span>
<span class="line"><span>Speaks with the voices of this machine for facciads elsewhere that share the same Redis.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --config FILE            settings as JSON; the members stand in brackets below</span></span>
<span class="line"><span>  -h, --help                   print this and exit</span></span>
<span class="line"><span>      --version                print the version and exit</span></span>
<span class="line"><span></span></span>
<span class="line"><span>      --workers N              processes for each voice plugin, 1 to 64 (1) [voices.workers]</span></span>
<span class="line"><span>      --spare-workers N        as many more while one takes long over a sentence and others wait, or does not answer; 0 = none, 0 to 64 (1) [voices.spare_workers]</span></span>
<span class="line"><span>      --voice-start S          requests wait so long for voices that are still starting; then they do without those, 0.1 to 3600 (30) [voices.start_seconds]</span></span>
<span class="line"><span>      --deadline-base S        a sentence of which nothing has come for so long is given up, and its worker is killed, 0.1 to 3600 (10) [voices.deadline_base]</span></span>
<span class="line"><span>      --deadline-per-byte S    added to that for each byte of the sentence&#39;s text, 0 to 10 (0.05) [voices.deadline_per_byte]</span></span>
<span class="line"><span>      --deadline-most X        the longest that a sentence may take in all, in multiples of that time, 1 to 1000 (10) [voices.deadline_most]</span></span>
<span class="line"><span>      --worker-processor X     the processor time that it may take, in multiples of the same time, 0.01 to 1000 (20) [voices.processor]</span></span>
<span class="line"><span>      --worker-memory N        address space of a worker, megabytes, 64 to 1048576 (4096) [voices.memory_megabytes]</span></span>
<span class="line"><span>      --sandbox on|off         workers are refused the network, programs and other system calls that their plugin does not need (on) [voices.sandbox]</span></span>
<span class="line"><span>      --voice-config FILE      JSON object: the settings of each plugin, by its name [voices.plugins]</span></span>
<span class="line"><span>      --cluster URL            share rooms and finished sentences with other daemons, and the voices of faccia-worker, over the Redis at redis://[[USER]:PASSWORD@]HOST[:PORT][/N] [cluster.address]</span></span>
<span class="line"><span>      --stop-seconds N         after SIGTERM, speech may go on for so many seconds, 0 to 3600 (5) [limits.stop_seconds]</span></span>
<span class="line"><span>      --log text|json          how log lines look (text) [log.format]</span></span>
<span class="line"><span>      --plugins DIR            voice plugins [paths.plugins]</span></span>
<span class="line"><span>      --worker FILE            the program that runs voice plugins [paths.worker]</span></span>
<span class="line"><span></span></span>
<span class="line"><span>Every such option can also be given in the environment, as FACCIA_WORKERS for --workers, and so on; the file is</span></span>
<span class="line"><span>$FACCIA_CONFIG. Options override the environment, which overrides the file.</span></span></code></pre></div><h2 id="faccia-mqtt" tabindex="-1">faccia-mqtt <a class="header-anchor" href="#faccia-mqtt" aria-label="Permalink to &quot;faccia-mqtt&quot;">​</a></h2><div class="language-txt vp-adaptive-theme"><button title="Copy Code" class="copy"></button><span class="lang">txt</span><pre class="shiki shiki-themes github-light github-dark vp-code" tabindex="0"><code><span class="line"><span>Usage: faccia-mqtt [OPTION]...</span></span>
<span class="line"><span>Brings rooms of a running facciad to an MQTT broker: topics of their own, Home Assistant&#39;s discovery, and</span></span>
<span class="line"><span>Rhasspy&#39;s hermes/tts/say. protocol/mqtt.md says which.</span></span>
<span class="line"><span></span></span>
<span class="line"><span>  -r, --room NAME         a room; as often as there are rooms (home)</span></span>
<span class="line"><span>  -b, --broker HOST[:PORT] the broker (127.0.0.1:1883; with --ca-file port 8883)</span></span>
<span class="line"><span>      --user NAME         and its password from FACCIA_MQTT_PASSWORD</span></span>
<span class="line"><span>      --ca-file FILE      speak TLS, and trust these certificates</span></span>
<span class="line"><span>      --client NAME       the session&#39;s name; each of several bridges has its own (faccia-mqtt)</span></span>
<span class="line"><span>      --base TOPIC        of the topics (faccia)</span></span>
<span class="line"><span>      --discovery TOPIC   of Home Assistant (homeassistant); none: no discovery</span></span>
<span class="line"><span>  -u, --url URL           the daemon (FACCIA_URL, else http://127.0.0.1:8080)</span></span>
<span class="line"><span>      --token-file FILE   its token (else FACCIA_TOKEN)</span></span>
<span class="line"><span>  -h, --help              print this and exit</span></span>
<span class="line"><span>      --version           print the version and exit</span></span>
<span class="line"><span>Exit status: 0 ended by a signal, 1 failed, 2 wrong usage.</span></span></code></pre></div></div>`);
}
const _sfc_setup = _sfc_main.setup;
_sfc_main.setup = (props, ctx) => {
  const ssrContext = useSSRContext();
  (ssrContext.modules || (ssrContext.modules = /* @__PURE__ */ new Set())).add("protocol/cli.md");
  return _sfc_setup ? _sfc_setup(props, ctx) : void 0;
};
const cli = /* @__PURE__ */ _export_sfc(_sfc_main, [["ssrRender", _sfc_ssrRender]]);
export {
  __pageData,
  cli as default
};
