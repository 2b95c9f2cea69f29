"""Limits of the messages that no broker holds back and that wait here."""

import asyncio

import aiomqtt

from service.mqtt import broker
from service.mqtt.broker import BoundedQueue


def message(qos: int, size: int = 10) -> aiomqtt.Message:
    """Return a message of a quality and a size [B]."""
    return aiomqtt.Message("a", bytes(size), qos, False, 1, None)


def test_of_quality_0_so_many_messages_wait_and_the_others_are_counted() -> None:
    queue = BoundedQueue()
    for _ in range(broker.QUEUE_MESSAGES + 7):
        queue.put_nowait(message(0))
    queue.put_nowait(message(1))
    assert (queue.qsize(), queue.take_dropped(), queue.take_dropped()) == (broker.QUEUE_MESSAGES + 1, 7, 0)


def test_of_quality_0_so_many_bytes_wait_and_there_is_room_again_behind_them() -> None:
    queue, size = BoundedQueue(), broker.LARGEST_PACKET
    for _ in range(40):
        queue.put_nowait(message(0, size))
    assert (queue.bytes, queue.take_dropped()) == (broker.QUEUE_BYTES, 8)
    assert len(asyncio.run(queue.get()).payload) == size
    queue.put_nowait(message(0, size))
    assert queue.take_dropped() == 0
