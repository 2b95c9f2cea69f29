// A client of the service's OPC UA server over node-opcua, an implementation of its own: requests come in as JSON, one a line, and
// answers and notifications go out the same way. The first line says where and how to connect.
"use strict";

const readline = require("node:readline");
const opcua = require("node-opcua-client");
const { OPCUACertificateManager } = require("node-opcua-certificate-manager");

const { AttributeIds, DataType, MessageSecurityMode, SecurityPolicy, StatusCodes, TimestampsToReturn, Variant } = opcua;

let session, client, subscription, listening;
const FIELDS = [
    "EventId", "EventType", "SourceName", "Time", "Message", "Severity", "ConditionName", "Retain", "ClientUserId", "Comment",
    "ActiveState", "ActiveState.Id", "AckedState.Id", "ConfirmedState.Id", "LatchedState.Id", "EnabledState.Id",
    "ShelvingState.CurrentState", "SuppressedState.Id", "OutOfServiceState.Id", "SuppressedOrShelved", "ConditionId",
];

function plain(value) {
    if (value === null || value === undefined) return null;
    if (Buffer.isBuffer(value)) return value.toString("base64");
    if (value instanceof Date) return value.toISOString();
    if (value instanceof opcua.LocalizedText) return value.text;
    if (value instanceof opcua.NodeId) return value.toString();
    if (Array.isArray(value) && value.length === 2 && typeof value[0] === "number") return value[0] * 2 ** 32 + value[1];
    if (value.constructor && value.constructor.name === "EUInformation") {
        return { unitId: value.unitId, displayName: value.displayName.text };
    }
    return value;
}

function reading(one) {
    return {
        value: one.value ? plain(one.value.value) : null,
        status: one.statusCode.name,
        source: one.sourceTimestamp ? one.sourceTimestamp.toISOString() : null,
    };
}

function say(what) {
    process.stdout.write(JSON.stringify({ at: Date.now() / 1000, ...what }) + "\n");
}

async function connect(how) {
    const secure = how.security !== "none";
    const manager = new OPCUACertificateManager({ rootFolder: how.folder, automaticallyAcceptUnknownCertificate: true });
    await manager.initialize();
    client = opcua.OPCUAClient.create({
        applicationName: "second stack",
        applicationUri: how.application,
        clientCertificateManager: manager,
        certificateFile: how.certificate,
        privateKeyFile: how.key,
        securityMode: secure ? MessageSecurityMode.SignAndEncrypt : MessageSecurityMode.None,
        securityPolicy: secure ? SecurityPolicy[how.security] : SecurityPolicy.None,
        endpointMustExist: false,
        connectionStrategy: { maxRetry: how.reconnects ? 100 : 0, initialDelay: 200, maxDelay: 500, randomisationFactor: 0 },
        keepSessionAlive: true,
    });
    await client.connect(how.endpoint);
    const user = how.user
        ? { type: opcua.UserTokenType.UserName, userName: how.user, password: how.password }
        : { type: opcua.UserTokenType.Anonymous };
    session = await client.createSession(user);
    subscription = await session.createSubscription2({
        requestedPublishingInterval: 100, requestedLifetimeCount: 1000, requestedMaxKeepAliveCount: 10, publishingEnabled: true,
    });
}

const requests = {
    async browse({ node }) {
        const found = await session.browse({ nodeId: node, referenceTypeId: "HierarchicalReferences", includeSubtypes: true, resultMask: 63 });
        return { status: found.statusCode.name, names: (found.references || []).map((one) => one.browseName.name) };
    },
    async browse_pages({ node, most }) {
        session.requestedMaxReferencesPerNode = most;
        const pages = [];
        try {
            let found = await session.browse({ nodeId: node, referenceTypeId: "HierarchicalReferences", includeSubtypes: true, resultMask: 63 });
            for (;;) {
                pages.push(found.references.map((one) => one.browseName.name));
                if (!found.continuationPoint || found.continuationPoint.length === 0) return pages;
                found = await session.browseNext(found.continuationPoint, false);
            }
        } finally {
            session.requestedMaxReferencesPerNode = 0;
        }
    },
    async browse_next({ point }) {
        return (await session.browseNext(Buffer.from(point, "base64"), false)).statusCode.name;
    },
    async read({ nodes, attribute }) {
        const attributeId = AttributeIds[attribute || "Value"];
        return (await session.read(nodes.map((nodeId) => ({ nodeId, attributeId })))).map(reading);
    },
    async write({ node, value }) {
        const written = { nodeId: node, attributeId: AttributeIds.Value, value: { value: { dataType: DataType.Double, value } } };
        return (await session.write(written)).name;
    },
    async find({ node, path }) {
        const found = await session.translateBrowsePath(opcua.makeBrowsePath(node, path));
        return { status: found.statusCode.name, nodes: (found.targets || []).map((one) => one.targetId.toString()) };
    },
    async watch({ nodes }) {
        const items = nodes.map((nodeId) => ({ nodeId, attributeId: AttributeIds.Value }));
        const group = await subscription.monitorItems(items, { samplingInterval: 0, queueSize: 10, discardOldest: true }, TimestampsToReturn.Both);
        const own = client;
        group.on("changed", (item, value) => client === own && say({ told: "value", node: item.itemToMonitor.nodeId.toString(), ...reading(value) }));
        return group.monitoredItems.map((one) => one.statusCode.name);
    },
    async listen({ node }) {
        const filter = opcua.constructEventFilter(FIELDS, opcua.ofType("AcknowledgeableConditionType"));
        const item = await subscription.monitor(
            { nodeId: node, attributeId: AttributeIds.EventNotifier }, { samplingInterval: 0, queueSize: 1000, filter }, TimestampsToReturn.Both);
        const own = client;
        item.on("changed", (values) => {
            if (client === own) say({ told: "event", ...Object.fromEntries(FIELDS.map((name, index) => [name, plain(values[index].value)])) });
        });
        listening = item.monitoredItemId;
        return item.statusCode.name;
    },
    async alarms() {
        const list = await opcua.installAlarmMonitoring(session);
        await new Promise((resolve) => setTimeout(resolve, 500));
        return list.alarms().map((one) => ({ name: one.fields.conditionName.value, retain: one.getRetain(), acked: one.fields.ackedState.id.value }));
    },
    async refresh() {
        const method = { objectId: "i=2782", methodId: "i=3875" };
        const argument = new Variant({ dataType: DataType.UInt32, value: subscription.subscriptionId });
        return (await session.call({ ...method, inputArguments: [argument] })).statusCode.name;
    },
    async refresh_item({ item }) {
        const method = { objectId: "i=2782", methodId: "i=12912" };
        const inputArguments = [subscription.subscriptionId, item === undefined ? listening : item].map(
            (value) => new Variant({ dataType: DataType.UInt32, value }));
        return (await session.call({ ...method, inputArguments })).statusCode.name;
    },
    async acknowledge({ condition, event, comment }) {
        return (await session.acknowledgeCondition(condition, Buffer.from(event, "base64"), comment)).name;
    },
    async confirm({ condition, event, comment }) {
        return (await session.confirmCondition(condition, Buffer.from(event, "base64"), comment)).name;
    },
    async comment({ condition, event, comment }) {
        return (await session.addCommentCondition(condition, Buffer.from(event, "base64"), comment)).name;
    },
    async call({ object, method, values }) {
        const inputArguments = (values || []).map(([type, value]) => new Variant({ dataType: DataType[type], value }));
        return (await session.call({ objectId: object, methodId: method, inputArguments })).statusCode.name;
    },
    async aggregate({ node, begin, end, function: name, interval }) {
        const found = await session.readAggregateValue(
            { nodeId: node }, new Date(begin), new Date(end), opcua.AggregateFunction[name], interval);
        if (found.statusCode.value >= 0x80000000) return found.statusCode.name;
        return found.historyData.dataValues.map(reading);
    },
    async history({ node, begin, end, count, continuation }) {
        const details = new opcua.ReadRawModifiedDetails({
            isReadModified: false, startTime: begin ? new Date(begin) : null, endTime: end ? new Date(end) : null,
            numValuesPerNode: count || 0, returnBounds: false,
        });
        const request = new opcua.HistoryReadRequest({
            historyReadDetails: details, timestampsToReturn: TimestampsToReturn.Both, releaseContinuationPoints: false,
            nodesToRead: [{ nodeId: node, continuationPoint: continuation ? Buffer.from(continuation, "base64") : undefined }],
        });
        const [found] = (await session.historyRead(request)).results;
        return {
            status: found.statusCode.name,
            values: ((found.historyData && found.historyData.dataValues) || []).map(reading),
            continuation: found.continuationPoint && found.continuationPoint.length ? found.continuationPoint.toString("base64") : null,
        };
    },
};

// Serve one connection until the line that ends it; a line after that begins another one, without loading the library again.
async function serve(how, lines) {
    try {
        await connect(how);
    } catch (error) {
        await client?.disconnect().catch(() => {});
        say({ refused: String(error.message) });
        return;
    }
    const own = client;
    const tell = (what) => () => { if (client === own) say({ told: what }); };
    client.on("close", tell("closed"));
    client.on("after_reconnection", tell("reconnected"));
    session.on("session_closed", tell("closed"));
    say({ connected: true });
    for (;;) {
        const line = await lines.next();
        if (line.done) return;
        const { number, request, ...rest } = JSON.parse(line.value);
        if (request === "end") break;
        try {
            say({ number, answer: await requests[request](rest) });
        } catch (error) {
            say({ number, failed: String(error.message) });
        }
    }
    client = undefined;
    await own.disconnect();
    say({ ended: true });
}

async function main() {
    const lines = readline.createInterface({ input: process.stdin })[Symbol.asyncIterator]();
    for (;;) {
        const line = await lines.next();
        if (line.done) process.exit(0);
        await serve(JSON.parse(line.value), lines);
    }
}

main();
