# SPDX-License-Identifier: GPL-3.0-or-later
# What client.test.mjs asks of faccia.py: client.py URL VECTORS; says what it found as JSON.
import asyncio
import json
import sys

import faccia


def vectors(path):
    """Chunks of the contract that are read otherwise than they should be."""
    wrong = []
    table = json.load(open(path, encoding="utf-8"))
    for row in table["good"] + table["loose"]:
        chunk = faccia.decode_chunk(bytes.fromhex(row["hex"]))
        found = [chunk.utterance, chunk.sample_rate, round(chunk.fps * 100), chunk.start, chunk.samples, chunk.first_frame]
        right = [row[name] for name in ("utterance", "rate", "fps_hundreds", "start", "samples", "first_frame")]
        frames = [{str(n): value for n, value in enumerate(frame) if value} for frame in chunk.frames]
        held = [{n: value for n, value in frame["values"].items() if value} for frame in row["frames"]]
        if found != right or frames != held:
            wrong.append(row["name"])
    for row in table["bad"]:
        try:
            faccia.decode_chunk(bytes.fromhex(row["hex"]))
            wrong.append(row["name"])
        except faccia.ChunkError:
            pass
    return wrong


async def speak(client, text):
    words, samples, opened, end = [], 0, 0, None
    async for event in client.speak(text, lang="it"):
        if isinstance(event, faccia.Media):
            samples += len(event.pcm) // 2
            opened = max([opened, *(frame[3] for frame in event.frames)])
        elif event["type"] == "word":
            words.append(event["text"])
        elif event["type"] == "end":
            end = event
    return {"words": words, "samples": samples, "opened": opened, "reason": end["reason"], "duration": end["duration"]}


async def first_word(client):
    async for event in client:
        if not isinstance(event, faccia.Media) and event["type"] == "word":
            return event["text"]


async def main(url, path):
    found = {"wrong": vectors(path), "client": sorted(faccia.CLIENT_MESSAGES), "server": sorted(faccia.SERVER_MESSAGES)}
    async with faccia.connect(url, room="cucina") as listener, faccia.connect(url, room="cucina") as client:
        found["protocol"] = client.hello["protocol"]
        heard = asyncio.ensure_future(first_word(listener))
        await asyncio.sleep(0)  # it listens
        found["spoken"] = await speak(client, "La mamma parla piano.")
        found["heard"] = await heard
        written = client.open(lang="it")
        for token in ("Buon", "giorno. ", "Come ", "stai?"):
            await written.write(token)
        await written.close()
        found["written"] = (await written.done())["reason"]
        said = client.voice(16000, lang="it")
        for _ in range(25):
            await said.sound(b"\0" * 640)
        await said.close()
        found["said"] = [event["reason"] if not isinstance(event, faccia.Media) and event["type"] == "end" else "" async for event in said][-1]
        found["refused"] = [event.get("code", event.get("reason")) async for event in client.speak("Ciao.", lang="xx")]
        lost = client.speak("Una frase lunga che non finisce mai, perché la connessione si perde.", lang="it")
        async for event in lost:
            if isinstance(event, faccia.Media):
                await client.close()
                break
        found["lost"] = [(await lost.done())["reason"], (await client.speak("Nessuno.").done())["reason"]]
    print(json.dumps(found))


asyncio.run(main(*sys.argv[1:]))
