"""The client for asyncio. It runs each call of the synchronous client in a thread of a pool.

    async with geodesicd.AsyncClient() as client:
        bunny = await client.upload("bunny", "bunny.obj")
        distances = await asyncio.gather(*(bunny.distance(12, i) for i in range(100)))
        async for mesh in client.meshes(): ...
"""
from __future__ import annotations

import asyncio
import concurrent.futures
import functools
from typing import Any, AsyncIterator, Callable, Dict, Iterator

from .client import Batch, Client, Resource
from .jobs import Job

_AT_ONCE = ("mesh", "subdivision", "nurbs")  # methods that send no request and are not awaited
_ITERATORS = ("pages", "meshes", "batch_results", "results")
_END = object()


class _Async:
    """Wraps an object of the client. Its methods become coroutines, and its iterators become
    asynchronous iterators."""

    def __init__(self, target: Any, pool: concurrent.futures.Executor):
        self._target, self._pool = target, pool

    def __repr__(self) -> str:
        return f"<async {self._target!r}>"

    def __getitem__(self, name: str) -> Any:
        return self._target[name]

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._target, name)
        if not callable(value):
            return self._wrap(value)
        if name in _AT_ONCE:
            return lambda *arguments: self._wrap(value(*arguments))
        if name in _ITERATORS:
            return lambda *arguments, **named: self._iterate(value(*arguments, **named))
        return functools.partial(self._call, value)

    def _wrap(self, value: Any) -> Any:
        return _Async(value, self._pool) if isinstance(value, (Resource, Job, Batch)) else value

    async def _run(self, function: Callable[..., Any], *arguments: Any) -> Any:
        return self._wrap(await asyncio.get_running_loop().run_in_executor(self._pool, function, *arguments))

    async def _call(self, method: Callable[..., Any], *arguments: Any, **named: Any) -> Any:
        """Runs a method in the pool. Calls a `progress` function in the event loop."""
        if callable(named.get("progress")):
            named["progress"] = functools.partial(asyncio.get_running_loop().call_soon_threadsafe, named["progress"])
        return await self._run(functools.partial(method, *arguments, **named))

    async def _iterate(self, iterator: Iterator[Any]) -> AsyncIterator[Any]:
        while True:
            item: Dict[str, Any] = await self._run(next, iterator, _END)
            if item is _END:
                return
            yield item


class AsyncClient(_Async):
    """A connection to a daemon with the methods of `Client` as coroutines. `parallel` is the number
    of simultaneous requests. If a task is cancelled, its call still runs to the end in its
    thread."""

    def __init__(self, *arguments: Any, parallel: int = 16, **named: Any):
        super().__init__(Client(*arguments, **named), concurrent.futures.ThreadPoolExecutor(parallel, "geodesicd"))

    async def __aenter__(self) -> "AsyncClient":
        return self

    async def __aexit__(self, *_: Any) -> None:
        await self.close()

    async def close(self) -> None:
        """Waits for the running calls, then closes the connections."""
        await asyncio.get_running_loop().run_in_executor(None, self._pool.shutdown)
        self._target.close()
