"""Reports of machines as PDF: what is told is read from the store, then laid out, drawn as SVG and printed in a worker
process, and sent by mail at the end of each week or month. It needs neither a browser nor a network.
"""
